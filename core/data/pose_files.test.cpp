#include <zlib.h>

#include <catch2/catch.hpp>

#include "core/data/robotevt.hpp"
#include "core/data/tum.hpp"
#include "core/geometry/so3.hpp"
#include "core/io/atomic_file.hpp"
#include "core/support/error.hpp"
#include "core/testing/data.hpp"

using namespace evbench;
using Catch::Matchers::Contains;

namespace {

PoseTrajectory tum(const std::string& content) {
  const testing::TemporaryFolder folder;
  return read_tum(folder.write("poses.txt", content));
}

PoseTrajectory robotevt(const std::string& content) {
  const testing::TemporaryFolder folder;
  return read_robotevt(folder.write("poses.txt", content));
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
  CHECK(worst_difference(read_robotevt(folder.file("a.txt")), unix_time_example()) < 1e-9);
}

TEST_CASE("TUM columns are t px py pz qx qy qz qw; comments and blank lines are skipped") {
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
  CHECK_THROWS_WITH(read_tum("/no/such/file"), Contains("no such file"));
  CHECK_THROWS_WITH(tum(""), Contains("holds no pose"));
  CHECK_THROWS_WITH(tum("# only a comment\n"), Contains("holds no pose"));
  CHECK_THROWS_WITH(tum(good + "1 0 0 0 0 0 1\n"), Contains("poses.txt:2: has 7 columns; expected 8"));
  CHECK_THROWS_WITH(tum(good + "1 nan 0 0 0 0 0 1\n"), Contains("poses.txt:2") && Contains("nan"));
  CHECK_THROWS_WITH(tum(good + "1 0 inf 0 0 0 0 1\n"), Contains("poses.txt:2") && Contains("inf"));
  CHECK_THROWS_WITH(tum(good + "1 0 zero 0 0 0 0 1\n"), Contains("zero"));
  CHECK_THROWS_WITH(tum(good + "1 0 0 0 0 0 0 0\n"), Contains("has norm 0"));
  CHECK_THROWS_WITH(tum(good + "1 0 0 0 0 0 0 1.1\n"), Contains("has norm 1.1"));
  CHECK_THROWS_WITH(tum(good + good), Contains("poses.txt:2") && Contains("the same as the one before"));
  CHECK_THROWS_WITH(tum(good + "-1 0 0 0 0 0 0 1\n"), Contains("poses.txt:2") && Contains("strictly increasing"));
}

TEST_CASE("A damaged RobotEvt file is refused with the line and what is wrong") {
  const std::string good = "0 1 0 0 0 1 0 0 0 1 0 0 0\n";
  CHECK_THROWS_WITH(robotevt(""), Contains("holds no pose"));
  CHECK_THROWS_WITH(robotevt("0 0 0 0 0 0 0 1\n"), Contains("has 8 columns; expected 13"));
  CHECK_THROWS_WITH(robotevt("0 1 0 0 0 1 0 0 0 -1 0 0 0\n"), Contains("reflection"));
  CHECK_THROWS_WITH(robotevt("0 1 0 0 0 1 0 0 0 1.1 0 0 0\n"), Contains("not a rotation"));
  CHECK_THROWS_WITH(robotevt("0 nan 0 0 0 1 0 0 0 1 0 0 0\n"), Contains("nan"));
  CHECK_THROWS_WITH(robotevt(good + good), Contains("poses.txt:2"));
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
  CHECK_THROWS_WITH(read_tum(folder.write("cut.gz", bytes.substr(0, bytes.size() / 2))), Contains("truncated"));
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
