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

TEST_CASE("A damaged TUM file is refused with the line and what is wrong") {
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

TEST_CASE("A damaged RobotEvt file is refused with the line and what is wrong") {
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

TEST_CASE("TUM trajectories may have commas, a line of names, further columns") {
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

TEST_CASE("Columns are in the order that names say") {
  check_quarter_turn(poses("qw,qx,qy,qz,pos_x,pos_y,pos_z,t_us\n0.70710678,0,0,0.70710678,1,2,3,500000\n"), 0.5);
  CHECK_THROWS_WITH(poses("t a b c\n0 1 2 3\n"),
                    ContainsSubstring("poses.txt:1: names the columns \"t a b c\"; expected names such "
                                      "as t px py pz qx qy qz qw, or numbers"));
  check_quarter_turn(poses("a b c d e f g h\n0.5 1 2 3 0 0 0.70710678 0.70710678\n", {.format = PoseFormat::tum}), 0.5);
}

TEST_CASE("EuRoC's ground truth is known by its names or by its columns, in nanoseconds") {
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

TEST_CASE("KITTI's matrices come with times in a file of their own, in the line, or are numbered on request") {
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

TEST_CASE("Poses with the time of the one before are left out, and that is said") {
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

TEST_CASE("Times that are closer to one another than a nanosecond are written apart") {
  const PoseTrajectory close({{0.25, {}}, {0.2500000001, {}}, {1.0 / 3.0, {}}, {0.5, {}}});
  CHECK(worst_difference(tum(format_tum(close)), close) == 0.0);
  CHECK_THAT(format_tum(close), Catch::Matchers::StartsWith("0.250000000 0.0000000000 "));
}
