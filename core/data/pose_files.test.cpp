#include <zlib.h>

#include "core/data/pose_file.hpp"
#include "core/data/robotevt.hpp"
#include "core/data/tum.hpp"
#include "core/geometry/so3.hpp"
#include "core/io/atomic_file.hpp"
#include "core/support/error.hpp"
#include "core/testing/catch2.hpp"
#include "core/testing/data.hpp"

using namespace evbench;
using Catch::Matchers::ContainsSubstring;

namespace {

PoseTrajectory tum(const std::string& content) {
  const testing::TemporaryFolder folder;
  return read_tum(folder.write("poses.txt", content));
}

PoseFile poses(const std::string& content, const PoseFileOptions& options = {}) {
  const testing::TemporaryFolder folder;
  return read_poses(folder.write("poses.txt", content), options);
}

PoseTrajectory robotevt(const std::string& content) {
  return poses(content, {.format = PoseFormat::robotevt}).trajectory;
}

PoseTrajectory unix_time_example() {
  std::vector<StampedPose> poses;
  for (int i = 0; i < 50; ++i) {
    const Vector3 phi(0.03 * i, -0.02 * i, 0.05 * i);
    poses.push_back({1504645192.575956305 + 0.001 * i, {so3::exp(phi), {123.456789 * i, -1e-7 * i, 1.0 / (i + 3)}}});
  }
  return PoseTrajectory(std::move(poses));
}

double worst_difference(const PoseTrajectory& a, const PoseTrajectory& b) {
  REQUIRE(a.size() == b.size());
  double worst = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    REQUIRE(a.poses()[i].t == b.poses()[i].t);
    worst = std::max(worst, se3::log(a.poses()[i].T.inverse() * b.poses()[i].T).cwiseAbs().maxCoeff());
  }
  return worst;
}

}  // namespace

TEST_CASE("A TUM file reads back as written, with absolute Unix time without loss") {
  const testing::TemporaryFolder folder;
  write_file(folder.file("a.txt"), format_tum(unix_time_example()));
  CHECK(worst_difference(read_tum(folder.file("a.txt")), unix_time_example()) < 1e-9);
}

TEST_CASE("A RobotEvt file reads back as written") {
  const testing::TemporaryFolder folder;
  write_file(folder.file("a.txt"), format_robotevt(unix_time_example()));
  CHECK(worst_difference(read_poses(folder.file("a.txt")).trajectory, unix_time_example()) < 1e-9);
}

TEST_CASE("TUM columns are t px py pz qx qy qz qw, comments and blank lines are skipped") {
  const PoseTrajectory poses = tum("# comment\n\n0.5 1 2 3 0 0 0.70710678 0.70710678\r\n");
  REQUIRE(poses.size() == 1);
  CHECK(poses.start() == 0.5);
  CHECK(poses.poses()[0].T.p == Vector3(1, 2, 3));
  CHECK((poses.poses()[0].T * Vector3(1, 0, 0) - Vector3(1, 3, 3)).norm() < 1e-12);
}

TEST_CASE("RobotEvt rotations are T_world_camera, row by row, and made exact") {
  const PoseTrajectory poses = robotevt("0 0 -1.001 0 1 0 0 0 0 1 1 2 3\n");
  CHECK((poses.poses()[0].T * Vector3(1, 0, 0) - Vector3(1, 3, 3)).norm() < 1e-3);
  CHECK(poses.poses()[0].T.q.norm() == Approx(1.0).margin(1e-15));
}

TEST_CASE("A slightly unnormalised quaternion is normalised") {
  CHECK(tum("0 0 0 0 0 0 0 1.005\n").poses()[0].T.q.w() == 1.0);
}

TEST_CASE("A damaged TUM file is refused with its line and fault") {
  const std::string good = "0 0 0 0 0 0 0 1\n";
  CHECK_THROWS_AS(read_tum("/no/such/file"), InputError);
  CHECK_THROWS_WITH(read_tum("/no/such/file"), ContainsSubstring("no such file"));
  CHECK_THROWS_WITH(tum(""), ContainsSubstring("holds no pose"));
  CHECK_THROWS_WITH(tum("# only a comment\n"), ContainsSubstring("holds no pose"));
  CHECK_THROWS_WITH(tum(good + "1 0 0 0 0 0 1\n"), ContainsSubstring("poses.txt:2: has 7 columns; expected 8"));
  CHECK_THROWS_WITH(tum(good + "1 nan 0 0 0 0 0 1\n"), ContainsSubstring("poses.txt:2") && ContainsSubstring("nan"));
  CHECK_THROWS_WITH(tum(good + "1 0 inf 0 0 0 0 1\n"), ContainsSubstring("poses.txt:2") && ContainsSubstring("inf"));
  CHECK_THROWS_WITH(tum(good + "1 0 zero 0 0 0 0 1\n"), ContainsSubstring("zero"));
  CHECK_THROWS_WITH(tum(good + "1 0 0 0 0 0 0 0\n"), ContainsSubstring("has norm 0"));
  CHECK_THROWS_WITH(tum(good + "1 0 0 0 0 0 0 1.1\n"), ContainsSubstring("has norm 1.1"));
  CHECK_THROWS_WITH(tum(good + "-1 0 0 0 0 0 0 1\n"),
                    ContainsSubstring("poses.txt:2") && ContainsSubstring("increasing times"));
}

TEST_CASE("A damaged RobotEvt file is refused with its line and fault") {
  const std::string good = "0 1 0 0 0 1 0 0 0 1 0 0 0\n";
  CHECK_THROWS_WITH(robotevt(""), ContainsSubstring("holds no pose"));
  CHECK_THROWS_WITH(robotevt("0 0 0 0 0 0 0 1\n"), ContainsSubstring("has 8 columns; expected 13"));
  CHECK_THROWS_WITH(robotevt("0 1 0 0 0 1 0 0 0 -1 0 0 0\n"), ContainsSubstring("reflection"));
  CHECK_THROWS_WITH(robotevt("0 1 0 0 0 1 0 0 0 1.1 0 0 0\n"), ContainsSubstring("not a rotation"));
  CHECK_THROWS_WITH(robotevt("0 nan 0 0 0 1 0 0 0 1 0 0 0\n"), ContainsSubstring("nan"));
}

namespace {

/// The position 1 2 3 and a quarter turn about z in each layout.
void check_quarter_turn(const PoseFile& file, double t) {
  REQUIRE(file.trajectory.size() == 1);
  CHECK(file.trajectory.start() == t);
  CHECK(file.trajectory.poses()[0].T.p == Vector3(1, 2, 3));
  CHECK((file.trajectory.poses()[0].T * Vector3(1, 0, 0) - Vector3(1, 3, 3)).norm() < 1e-7);
}

}  // namespace

TEST_CASE("TUM trajectories may have commas, a line of names, and further columns") {
  check_quarter_turn(poses("0.5 1 2 3 0 0 0.70710678 0.70710678\n"), 0.5);
  check_quarter_turn(poses("0.5,1,2,3,0,0,0.70710678,0.70710678\n"), 0.5);
  check_quarter_turn(poses("time,x,y,z,qx,qy,qz,qw\n0.5,1,2,3,0,0,0.70710678,0.70710678\n"), 0.5);
  check_quarter_turn(poses("0.5 1 2 3 0 0 0.70710678 0.70710678 7\n"), 0.5);
  CHECK(poses("0.5 1 2 3 0 0 0 1\n").remarks.empty());
  CHECK(poses("# timestamp tx ty tz qx qy qz qw\n0.5 1 2 3 0 0 0 1\n").remarks.empty());
  CHECK_THAT(poses("0.5,1,2,3,0,0,0,1\n").remarks.at(0),
             ContainsSubstring("poses.txt: read with columns t px py pz qx qy qz qw (assumed)"));
  CHECK_THAT(poses("0.5 1 2 3 0 0 0 1 7\n").remarks.at(0), ContainsSubstring("t px py pz qx qy qz qw - (assumed)"));
}

TEST_CASE("Column names give the order of the columns") {
  check_quarter_turn(poses("qw,qx,qy,qz,pos_x,pos_y,pos_z,t_us\n0.70710678,0,0,0.70710678,1,2,3,500000\n"), 0.5);
  CHECK_THROWS_WITH(poses("t a b c\n0 1 2 3\n"),
                    ContainsSubstring("poses.txt:1: names the columns \"t a b c\"; expected names such "
                                      "as t px py pz qx qy qz qw, or numbers"));
  check_quarter_turn(poses("a b c d e f g h\n0.5 1 2 3 0 0 0.70710678 0.70710678\n", {.format = PoseFormat::tum}), 0.5);
}

TEST_CASE("The header's stamp is preferred to the other times of a printed topic") {
  const std::string pose =
      "field.pose.position.x,field.pose.position.y,field.pose.position.z,"
      "field.pose.orientation.x,field.pose.orientation.y,field.pose.orientation.z,"
      "field.pose.orientation.w";
  check_quarter_turn(poses("%time,field.header.seq,field.header.stamp,field.header.frame_id," + pose +
                           "\n1403636580938555648,0,1403636580838555648,world,1,2,3,0,0,0.70710678,0.70710678\n"),
                     1403636580838555648 / 1e9);
  check_quarter_turn(poses("Time,header.stamp.secs,header.stamp.nsecs," + pose +
                           "\n1.5,1,500000000,1,2,3,0,0,0.70710678,0.70710678\n"),
                     1.5);
  check_quarter_turn(poses("#sec,nsec,x,y,z,qx,qy,qz,qw\n1583836591,182590976,1,2,3,0,0,0.70710678,0.70710678\n"),
                     1583836591.182590976);
  CHECK_THROWS_WITH(poses("sec,nsec,x,y,z,qx,qy,qz,qw\n1,1000000000,1,2,3,0,0,0,1\n"),
                    ContainsSubstring("poses.txt:2: the time's nanoseconds are 1000000000; expected 0 to 999999999"));
}

TEST_CASE("Names of two poses in a line are refused and quoted") {
  const std::string two =
      "box_px box_py box_pz box_qx box_qy box_qz box_qw cam_px cam_py cam_pz cam_qx cam_qy cam_qz "
      "cam_qw";
  const std::string numbers = "0 1 2 3 0 0 0 1 4 5 6 0 0 0 1\n";
  for (const std::string& text : {"t " + two + "\n" + numbers, "# t " + two + "\n" + numbers}) {
    CHECK_THROWS_WITH(poses(text), ContainsSubstring("poses.txt:") &&
                                       ContainsSubstring("\"box_px\" and \"cam_px\", either of which may be px"));
  }
  CHECK_THROWS_WITH(poses("t,field.pose.position.x,y,z,field.transform.translation.x,qx,qy,qz,qw\n0,1,2,3,4,0,0,0,1\n"),
                    ContainsSubstring("\"field.pose.position.x\" and \"field.transform.translation.x\""));
  CHECK_THROWS_WITH(poses("time,stamp,x,y,z,qx,qy,qz,qw\n0,0,1,2,3,0,0,0,1\n"),
                    ContainsSubstring("\"time\" and \"stamp\", either of which may be t"));
  CHECK(poses("t " + two + "\n" + numbers, {.format = PoseFormat::tum}).trajectory.poses()[0].T.p.x() == 1.0);
}

TEST_CASE("EuRoC's ground truth, in nanoseconds, is recognised by its names or its columns") {
  const std::string names =
      "#timestamp, p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w [], q_RS_x [], q_RS_y [], q_RS_z [], "
      "v_RS_R_x [m s^-1], v_RS_R_y [m s^-1], v_RS_R_z [m s^-1], b_w_RS_S_x [rad s^-1], b_w_RS_S_y [rad s^-1], "
      "b_w_RS_S_z [rad s^-1], b_a_RS_S_x [m s^-2], b_a_RS_S_y [m s^-2], b_a_RS_S_z [m s^-2]\n";
  const std::string pose = "1403636580838555648,1,2,3,0.70710678,0,0,0.70710678", more = ",4,5,6,7,8,9,10,11,12\n";
  for (const std::string& text : {names + pose + more, pose + more}) {
    const PoseFile file = poses(text);
    check_quarter_turn(file, 1403636580838555648 / 1e9);
    CHECK_THAT(file.remarks.at(0), ContainsSubstring("columns t px py pz qw qx qy qz - - - - - - - - - (") &&
                                       ContainsSubstring("times in nanoseconds"));
  }
  // As in TUM-VI, and as ORB-SLAM writes EuRoC's trajectories.
  check_quarter_turn(
      poses("#timestamp [ns], p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w [], q_RS_x [], q_RS_y [], "
            "q_RS_z []\n500000000,1,2,3,0.70710678,0,0,0.70710678\n"),
      0.5);
  check_quarter_turn(poses("1403636580838555648 1 2 3 0 0 0.70710678 0.70710678\n"), 1403636580838555648 / 1e9);
  check_quarter_turn(poses("0.5 1 2 3 0.70710678 0 0 0.70710678\n", {.format = PoseFormat::euroc}), 0.5);
}

TEST_CASE("Nanoseconds and commas without names are read in EuRoC's layout, as VINS writes them") {
  for (const char* more : {"\n", ",\n", ",0.1,0.2,0.3,\n"}) {
    const PoseFile file = poses("1403636580838555648,1,2,3,0.70710678,0,0,0.70710678" + std::string(more));
    check_quarter_turn(file, 1403636580838555648 / 1e9);
    CHECK(file.quaternion == QuaternionOrder::wxyz);
    CHECK(file.quaternion_is_assumed);
    CHECK_THAT(file.remarks.at(0), ContainsSubstring("qw qx qy qz") && ContainsSubstring("assumed"));
  }
}

TEST_CASE("A quaternion is read in the requested order, whatever the file's layout") {
  const struct {
    QuaternionOrder order;
    const char* text;
  } cases[] = {{QuaternionOrder::xyzw, "0 0 0.70710678 0.70710678"},
               {QuaternionOrder::wxyz, "0.70710678 0 0 0.70710678"},
               {QuaternionOrder::zwxy, "0.70710678 0.70710678 0 0"},
               {QuaternionOrder::yzwx, "0 0.70710678 0.70710678 0"}};
  for (const auto& [order, text] : cases) {
    CAPTURE(text);
    for (const char* names : {"", "# t px py pz qx qy qz qw\n", "t px py pz qw qx qy qz\n"}) {
      const PoseFile file = poses(fmt::format("{}0.5 1 2 3 {}\n", names, text), {.quaternion = order});
      check_quarter_turn(file, 0.5);
      CHECK(file.quaternion == order);
      CHECK_FALSE(file.quaternion_is_assumed);
    }
  }
  CHECK_THROWS_WITH(poses("0 1 0 0 1 0 1 0 2 0 0 1 3\n", {.quaternion = QuaternionOrder::wxyz}),
                    ContainsSubstring("has no quaternion") && ContainsSubstring("given as wxyz"));
  CHECK(poses("0.5 1 2 3 0 0 0 1\n").quaternion == QuaternionOrder::xyzw);
  CHECK(poses("t px py pz qz qy qx qw\n0.5 1 2 3 0 0 0 1\n").quaternion == QuaternionOrder::automatic);
}

TEST_CASE("KITTI's matrices have times in a separate file or in the line, or are numbered on request") {
  const testing::TemporaryFolder folder;
  const std::string matrix = "0 -1 0 1 1 0 0 2 0 0 1 3", next = "\n1 0 0 1 0 1 0 2 0 0 1 3\n";
  const std::string two = folder.write("times.txt", "5.0e-01\n6.0e-01\n"), one = folder.write("one.txt", "0.5\n");
  check_quarter_turn(poses(matrix, {.times = one}), 0.5);
  CHECK(poses(matrix + next, {.times = two}).trajectory.end() == 0.6);
  check_quarter_turn(poses("0.5 " + matrix), 0.5);
  check_quarter_turn(poses("0.5 " + matrix + " 0 0 0 1"), 0.5);
  const PoseFile numbered = poses(matrix + " 0 0 0 1", {.may_number = true});
  check_quarter_turn(numbered, 0.0);
  CHECK(numbered.numbered);
  CHECK_THAT(numbered.remarks.at(0), ContainsSubstring("without times: poses are numbered"));
  CHECK_THROWS_WITH(poses(matrix),
                    ContainsSubstring("poses.txt:1: has no time") && ContainsSubstring("a file with a time a line"));
  CHECK_THROWS_WITH(poses(matrix + next, {.times = one}), ContainsSubstring("poses.txt:2: has no time in " + one));
  CHECK_THROWS_WITH(poses(matrix, {.times = two}), ContainsSubstring("times.txt:2: a time without a pose"));
}

TEST_CASE("Poses with the time of the previous pose are dropped with a remark") {
  const PoseFile file = poses("0 1 0 0 0 0 0 1\n0 2 0 0 0 0 0 1\n1 3 0 0 0 0 0 1\n1 4 0 0 0 0 0 1\n");
  REQUIRE(file.trajectory.size() == 2);
  CHECK(file.trajectory.poses()[1].T.p.x() == 3.0);
  CHECK_THAT(file.remarks.at(0), ContainsSubstring("2 poses with the time of the one before, left out; the first: ") &&
                                     ContainsSubstring("poses.txt:2"));
}

TEST_CASE("Times too late for seconds need their unit") {
  const std::string late = "1403636580838555 0 0 0 0 0 0 1\n";
  CHECK_THROWS_WITH(poses(late), ContainsSubstring("poses.txt:1: the time is 1403636580838555, too late for seconds"));
  CHECK(poses(late, {.time_unit = TimeUnit::microseconds}).trajectory.start() == 1403636580838555 / 1e6);
  const PoseFile open = poses(late, {.may_lack_unit = true});
  CHECK(open.trajectory.start() == 1403636580838555);
  CHECK_THAT(open.unknown_unit, ContainsSubstring("poses.txt:1: the time is 1403636580838555, too late for seconds"));
  // The first time alone is not enough.
  CHECK_THROWS_WITH(poses("0 0 0 0 0 0 0 1\n" + late), ContainsSubstring("poses.txt:2: the time is 1403636580838555"));
  CHECK_THROWS_WITH(poses("0 0 0 0 0 0 0 1\n1403636580838555648 0 0 0 0 0 0 1\n"),
                    ContainsSubstring("poses.txt:2: the time is 1.4036365808385556e+18, too late for seconds"));
}

TEST_CASE("A truncated gzip file is refused, a whole one is read") {
  const testing::TemporaryFolder folder;
  const std::string text = format_tum(unix_time_example());
  const std::string whole = folder.file("whole.gz");
  gzFile file = gzopen(whole.c_str(), "wb");
  gzwrite(file, text.data(), static_cast<unsigned>(text.size()));
  gzclose(file);
  CHECK(read_tum(whole).size() == 50);
  const std::string bytes = testing::read_file(whole);
  CHECK_THROWS_WITH(read_tum(folder.write("cut.gz", bytes.substr(0, bytes.size() / 2))),
                    ContainsSubstring("truncated"));
}

TEST_CASE("The real ground truth of poster_translation reads whole") {
  const auto path = testing::data_file("poster_translation/groundtruth.txt");
  if (!path) return;
  const PoseTrajectory poses = read_tum(*path);
  CHECK(poses.size() == 11768);
  CHECK(poses.start() == 0.036104394);
}

TEST_CASE("Times less than a nanosecond apart are written as different numbers") {
  const PoseTrajectory close({{0.25, {}}, {0.2500000001, {}}, {1.0 / 3.0, {}}, {0.5, {}}});
  CHECK(worst_difference(tum(format_tum(close)), close) == 0.0);
  CHECK_THAT(format_tum(close), Catch::Matchers::StartsWith("0.250000000 0.0000000000 "));
}
