#include "core/data/causal_poses.hpp"

#include "core/geometry/so3.hpp"
#include "core/io/atomic_file.hpp"
#include "core/support/error.hpp"
#include "core/testing/catch2.hpp"
#include "core/testing/data.hpp"

using namespace evbench;
using Catch::Matchers::ContainsSubstring;

TEST_CASE("Causal poses are read back as written, with and without velocity, also of an older time again") {
  const SE3 T{so3::exp({0.1, -0.2, 1.0 / 3.0}), {1.0 / 7.0, -2.0, 3e-9}};
  const std::vector<CausalPose> poses = {
      {{1.0, T}, 1.1, {}}, {{1.05, T}, 1.1 + 1e-9, Vector6(Vector6::LinSpaced(0.1, 0.7))}, {{1.0, T}, 1.2, {}}};
  const testing::TemporaryFolder folder;
  write_file(folder.file("causal_poses.txt"), format_causal_poses(poses));
  const std::vector<CausalPose> read = read_causal_poses(folder.file("causal_poses.txt"));
  REQUIRE(read.size() == 3);
  for (std::size_t i = 0; i < 3; ++i) {
    CHECK(read[i].t == poses[i].t);
    CHECK(read[i].known_at == poses[i].known_at);
    CHECK(read[i].T.p == T.p);
    CHECK(read[i].T.q.angularDistance(T.q) < 1e-15);
    CHECK(read[i].velocity == poses[i].velocity);
  }
  folder.write("none.txt", format_causal_poses({}));
  CHECK(read_causal_poses(folder.file("none.txt")).empty());
}

TEST_CASE("A damaged file of causal poses is refused with its line") {
  const testing::TemporaryFolder folder;
  const auto refusal = [&](const std::string& text) {
    folder.write("causal_poses.txt", text);
    try {
      read_causal_poses(folder.file("causal_poses.txt"));
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  CHECK_THAT(refusal("1 1 0 0 0 0 0 0\n"),
             ContainsSubstring("causal_poses.txt:1") && ContainsSubstring("known_at t x y z qx qy qz qw"));
  CHECK_THAT(refusal("1 1 0 0 0 0 0 0 1\n0.5 0.5 0 0 0 0 0 0 1\n"),
             ContainsSubstring("causal_poses.txt:2") && ContainsSubstring("decrease"));
  CHECK_THAT(refusal("1 1 0 0 0 0 0 0 nan\n"), ContainsSubstring("causal_poses.txt:1"));
}
