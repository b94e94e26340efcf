#include "backends/gp_map/jump_profile.hpp"

#include <algorithm>
#include <cstdlib>

#include "core/testing/catch2.hpp"

namespace evbench::gp_map {
namespace {

/// Landmarks that are seen in all intervals from one to another.
struct Seen {
  static constexpr int kStates = 61;
  static constexpr double kStep = 0.01;  // [s]
  FactorGraph graph;

  Seen() {
    graph.qc = Vector6::Ones();
    for (int k = 0; k < kStates; ++k) graph.add_state({kStep * k, {}, Vector6::Zero()});
  }
  void add(int count, int from, int until) {
    for (int i = 0; i < count; ++i) {
      const int j = graph.add_landmark({0.0, 0.0, 1.0});
      for (int k = from; k <= until; ++k) graph.add_observation(j, {kStep * k, {0.0, 0.0}, 1.0});
    }
  }
};

/// The state at which half of the motion is complete.
int half(const JumpProfile& jump_profile, int first) {
  return first + static_cast<int>(std::ranges::find_if(jump_profile, [](double share) { return share >= 0.5; }) -
                                  jump_profile.begin());
}

}  // namespace

TEST_CASE("Profiles of a pose jump are sudden where few landmarks are seen before and after, or spread") {
  Seen seen;
  seen.add(20, 1, 29);
  seen.add(20, 30, 60);  // no landmark spans interval 30
  seen.add(4, 1, 44);
  seen.add(30, 46, 60);
  const int first = 10;
  const std::vector<JumpProfile> all = jump_profiles(seen.graph, first, {});
  REQUIRE(all.size() == 4);
  CHECK(half(all[0], first) == 30);
  for (const JumpProfile& jump_profile : all) {
    REQUIRE(jump_profile.size() == Seen::kStates - first);
    CHECK(std::ranges::is_sorted(jump_profile));
    CHECK(jump_profile.front() >= 0.0);
    CHECK(jump_profile[jump_profile.size() - 2] == Approx(1.0));
    CHECK(jump_profile.back() == Approx(1.0));
  }
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < i; ++j) CHECK(std::abs(half(all[i], first) - half(all[j], first)) >= 10);  // 0.1 s
  }
  const JumpProfile& spread = all.back();
  CHECK(half(spread, first) == 30);  // most of it where the fewest landmarks are
  CHECK(spread[5] > 0.0);
  CHECK(spread[index(40 - first)] < 1.0);
}

TEST_CASE("Landmarks that are left out do not hide the time of a pose jump") {
  Seen seen;
  seen.add(20, 1, 29);
  seen.add(20, 30, 60);
  seen.add(50, 20, 35);
  const auto moment = [&](const std::set<int>& left_out) {
    return half(jump_profiles(seen.graph, 10, left_out)[0], 10);
  };
  CHECK(moment({}) != 30);
  std::set<int> hiding;
  for (int j = 40; j < 90; ++j) hiding.insert(j);
  CHECK(moment(hiding) == 30);
}

TEST_CASE("A pose jump since the last state but one is sudden in each profile") {
  Seen seen;
  seen.add(10, 1, 60);
  const int first = Seen::kStates - 2;
  for (const JumpProfile& jump_profile : jump_profiles(seen.graph, first, {}))
    CHECK(jump_profile == JumpProfile{1.0, 1.0});
}

}  // namespace evbench::gp_map
