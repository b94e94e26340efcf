#include "backends/gp_map/modules/alternative_estimate.hpp"

#include <cstdint>
#include <iterator>
#include <tuple>
#include <utility>
#include <vector>

#include "backends/gp_map/observation_follower.hpp"
#include "backends/gp_map/testing/ambiguous_sequence.hpp"
#include "core/smoother/smoother.hpp"
#include "core/testing/catch2.hpp"

namespace evbench::gp_map {
namespace {

using namespace ambiguous_sequence;

/// Runs a search to its end.
std::optional<AlternativeEstimate> try_alternatives(const FactorGraph& graph, int first_state, int enough,
                                                    StructureHypothesis hypothesis, bool tentative = false) {
  auto search = AlternativeSearch::begin(graph, {first_state, static_cast<int>(graph.states.size()) - 1}, enough,
                                         hypothesis, tentative);
  if (!search) return std::nullopt;
  while (search->run_share()) {
  }
  return search->found();
}

}  // namespace

TEST_CASE("A local minimum that exchanges a plane's normal and the translation is replaced by the true estimate",
          "[slow]") {
  for (const auto& [motion, plane, tentative] :
       {std::tuple{CameraMotion{-0.4, 0.0}, StructureHypothesis::frontal_plane, false},
        {CameraMotion{0.0, 0.4}, StructureHypothesis::dual_plane, false},
        {CameraMotion{-0.4, 0.0}, StructureHypothesis::frontal_plane, true}}) {
    int found = 0;
    for (const std::uint64_t seed : {1, 2, 3}) {
      const Vector3 real = simulate_problem(motion, seed, tentative).states.back().T.p;
      const FactorGraph wrong = misled(simulate_problem(motion, seed, tentative));
      REQUIRE(cost(wrong) > cost(solved(simulate_problem(motion, seed, tentative))) + 15.0);
      const auto other = try_alternatives(wrong, 0, kEnough, plane, tentative);
      if (!other) continue;
      CHECK((other->first == 0) == tentative);
      CHECK(other->first + std::ssize(other->states) == std::ssize(wrong.states));
      Smoother smoother(wrong, {});
      other->place_in(smoother);
      smoother.optimise(20, 1e-9);
      const double error = (smoother.graph().states.back().T.p - real).norm();
      const double before = (wrong.states.back().T.p - real).norm();
      CHECK(error < before);
      if (error < 0.3 * before) ++found;
      CHECK(other->advantage > 10.0);
    }
    CHECK(found >= 2);  // of 3: one may be too hard to distinguish yet
  }
}

TEST_CASE("States and landmarks that were added since the search are moved along with the alternative") {
  const FactorGraph wrong = misled(simulate_problem({-0.4, 0.0}, 1));
  const auto other = try_alternatives(wrong, 0, kEnough, StructureHypothesis::frontal_plane);
  REQUIRE(other);
  Smoother smoother(wrong, {});
  smoother.add_state_at(kStep * kStates);
  const Vector3 in_camera(0.1, 0.2, 2.0);
  // A landmark is added with all observations of its track: one is seen by the new state, one only by an earlier one.
  for (const int k : {kStates, kStates - 3}) {
    const int landmark = smoother.add_landmark(smoother.graph().states[index(k)].T * in_camera);
    smoother.add_observation(landmark, {kStep * k, wrong.camera.project(in_camera), 1.0 / kSigma});
    if (k == kStates) smoother.add_observation(landmark, {kStep * (k - 4), wrong.camera.project(in_camera), 1e-6});
  }
  smoother.update_everything();
  const FactorGraph before = smoother.graph();
  other->place_in(smoother);
  const FactorGraph& after = smoother.graph();
  CHECK((after.states[kStates - 1].T.p - other->states.back().T.p).norm() < 1e-9);
  CHECK((after.states[kStates - 1].T.p - before.states[kStates - 1].T.p).norm() > 0.01);
  const auto newest_state = [](const FactorGraph& graph) {
    return Vector3((graph.states[kStates - 1].T.inverse() * graph.states[kStates].T).p);
  };
  CHECK((newest_state(after) - newest_state(before)).norm() < 1e-9);
  for (const auto& [k, landmark] : {std::pair{kStates, 0}, {kStates - 3, 1}}) {
    const auto seen = [&, k = k, landmark = landmark](const FactorGraph& graph) {
      const Vector3& position = graph.landmarks[index(ambiguous_sequence::kLandmarks + landmark)].position;
      return Vector3(graph.states[index(k)].T.inverse() * position);
    };
    CHECK((seen(after) - seen(before)).norm() < 1e-9);
  }
  for (int i = 0; i < 20; ++i) smoother.update_everything();
  CHECK(cost(smoother.graph()) < cost(before) - 10.0);
}

TEST_CASE("The true estimate has no better alternative, and without older landmarks only a tentative map is searched") {
  for (const CameraMotion& motion : {CameraMotion{-0.4, 0.0}, CameraMotion{0.0, 0.4}}) {
    const FactorGraph truth = solved(simulate_problem(motion, 1)), wrong = misled(simulate_problem(motion, 1));
    const bool turning = motion.turn != 0.0;
    REQUIRE(try_alternatives(wrong, 0, kEnough,
                             turning ? StructureHypothesis::frontal_plane : StructureHypothesis::dual_plane));
    for (const StructureHypothesis plane : {StructureHypothesis::frontal_plane, StructureHypothesis::dual_plane}) {
      CHECK_FALSE(try_alternatives(truth, 0, kEnough, plane));
      CHECK_FALSE(try_alternatives(solved(simulate_problem(motion, 1, true)), 0, kEnough, plane, true));
      CHECK_FALSE(try_alternatives(wrong, 1, kOld + 1, plane, true));  // marginalised: only a part is searched
      CHECK_FALSE(try_alternatives(wrong, 0, kOld + 1, plane));
      CHECK_FALSE(try_alternatives(wrong, kStates - 20, kEnough, plane));  // too little of it may change
    }
  }
}

}  // namespace evbench::gp_map
