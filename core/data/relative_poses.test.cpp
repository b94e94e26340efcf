#include "core/data/relative_poses.hpp"

#include "core/geometry/so3.hpp"
#include "core/io/atomic_file.hpp"
#include "core/testing/catch2.hpp"
#include "core/testing/data.hpp"

using namespace evbench;

TEST_CASE("Relative poses with covariances are read back as written, and a short line is refused") {
  RelativePose pose{"newest", 0.1, 1.0 / 3.0, {so3::exp({0.1, -0.2, 0.3}), {1.0 / 7.0, -2.0, 3e-9}}, {}};
  for (int i = 0; i < 36; ++i) pose.covariance(i / 6, i % 6) = 1.0 / (1.0 + i);
  const testing::TemporaryFolder folder;
  write_file(folder.file("c.txt"), format_relative_poses(std::vector{pose, pose}));
  const std::vector<RelativePose> read = read_relative_poses(folder.file("c.txt"));
  REQUIRE(read.size() == 2);
  CHECK(read[1].kind == "newest");
  CHECK(read[1].t1 == pose.t1);
  CHECK(read[1].T.p == pose.T.p);
  CHECK(read[1].covariance == pose.covariance);
  folder.write("c.txt", "newest 0 1 0 0 0 0 0 0 1 2 3\n");
  CHECK_THROWS_WITH(read_relative_poses(folder.file("c.txt")),
                    Catch::Matchers::ContainsSubstring("c.txt:1: has 12 columns"));
}
