#include "backends/gp_map/modules/recent_motion.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <utility>

namespace evbench::gp_map {
namespace {

constexpr double kWindow = 0.4;  ///< [s]
constexpr int kMostStates = 24;  ///< states

/// H δ = −g with H block-tridiagonal and positive definite.
class Chain {
 public:
  /// `n` states of this size.
  Chain(std::size_t n, int size)
      : diagonal(n, StateMatrix::Zero(size, size)), below(diagonal), gradient(n, StateVector::Zero(size)) {}

  std::vector<StateMatrix> diagonal, below;  ///< H(i, i), H(i, i − 1)
  std::vector<StateVector> gradient;         ///< g(i)

  /// False where H is singular.
  bool factorise() {
    for (std::size_t i = 0; i < diagonal.size(); ++i) {
      if (i > 0) {
        gains_.push_back(factors_.back().solve(below[i].transpose()));
        diagonal[i] -= below[i] * gains_.back();
        gradient[i] -= gains_.back().transpose() * gradient[i - 1];
      }
      factors_.emplace_back(diagonal[i]);
      if (factors_.back().info() != Eigen::Success) return false;
    }
    return true;
  }

  std::vector<StateVector> solution() const {
    std::vector<StateVector> delta(diagonal.size());
    for (std::size_t i = delta.size(); i-- > 0;) {
      delta[i] = -factors_[i].solve(gradient[i]);
      if (i + 1 < delta.size()) delta[i] -= gains_[i] * delta[i + 1];
    }
    return delta;
  }

  /// Joint covariances of i and i + 1, for all i.
  std::vector<PairMatrix> covariances() const {
    std::vector<PairMatrix> joint(diagonal.size() - 1);
    const StateMatrix one = StateMatrix::Identity(gradient[0].size(), gradient[0].size());
    StateMatrix newer = factors_.back().solve(one);
    for (std::size_t i = joint.size(); i-- > 0;) {
      const StateMatrix cross = -gains_[i] * newer;
      const StateMatrix older = factors_[i].solve(one) - gains_[i] * cross.transpose();
      joint[i].resize(2 * one.rows(), 2 * one.rows());
      joint[i] << older, cross, cross.transpose(), newer;
      newer = older;
    }
    return joint;
  }

 private:
  std::vector<Eigen::LLT<StateMatrix>> factors_;
  std::vector<StateMatrix> gains_;  ///< gains_[i] = H(i)⁻¹ H(i, i + 1), the older ones eliminated
};

}  // namespace

void RecentMotion::follow(const FactorGraph& graph, int first_state) {
  const int newest = static_cast<int>(graph.states.size()) - 1;
  int first = newest;
  while (first > first_state && newest - first + 1 < kMostStates &&
         graph.states[index(first - 1)].t > graph.states[index(newest)].t - kWindow) {
    --first;
  }
  const std::vector<ControlState> published =
      std::exchange(states_, {graph.states.begin() + first, graph.states.end()});
  if (first == newest || !prior_) return;

  const int n = graph.state_size();
  Chain chain(states_.size(), n);
  std::vector<Vector6> qcs;  // of the intervals between states_
  const auto add_interval = [&](int k, const ControlState& before) {
    const ControlState& state = graph.states[index(k)];
    const IntervalObservations& observations = graph.intervals[index(k)];
    positions_.clear();
    for (const auto& group : observations.groups()) {
      positions_.push_back(graph.landmarks[index(group.landmark)].position);
    }
    const Vector6 qc = prior_->at(0.5 * (before.t + state.t));
    constexpr double kNoExpansion = 0.0;  // the map is held, so this prior cannot contract the world
    linearise_interval(
        {graph.camera, graph.loss, graph.motion_prior, qc, kNoExpansion, before, state, observations, positions_},
        linearised_);
    const auto i = index(k - first);
    chain.diagonal[i] += linearised_.states.bottomRightCorner(n, n);
    chain.gradient[i] += linearised_.gradient.tail(n);
    if (i == 0) return;  // the state before is held
    chain.diagonal[i - 1] += linearised_.states.topLeftCorner(n, n);
    chain.gradient[i - 1] += linearised_.gradient.head(n);
    chain.below[i] = linearised_.states.bottomLeftCorner(n, n);
    qcs.push_back(qc);
  };
  if (first == 0) {
    const smoother::StateSystem priors = smoother::state_priors(graph, 0);
    chain.diagonal[0] += priors.H;
    chain.gradient[0] += priors.g;
  } else {  // held at its published pose
    const ControlState& estimate = graph.states[index(first - 1)];
    const auto before = std::ranges::find(published, estimate.t, &ControlState::t);
    add_interval(first, before == published.end() ? estimate : *before);
  }
  for (int k = first + 1; k <= newest; ++k) add_interval(k, graph.states[index(k - 1)]);
  if (!chain.factorise()) return;

  const std::vector<StateVector> delta = chain.solution();
  if (!std::ranges::all_of(delta, [](const StateVector& d) { return d.allFinite(); })) return;
  for (std::size_t i = 0; i < delta.size(); ++i) states_[i] = states_[i].retract(delta[i]);
  std::vector<PriorEvidence> evidence;
  for (const PairMatrix& joint : chain.covariances()) {
    const std::size_t i = evidence.size();
    evidence.push_back(evidence_of(GpInterval(states_[i], states_[i + 1], graph.motion_prior), joint, qcs[i]));
  }
  prior_->take(first + 1, evidence);
}

}  // namespace evbench::gp_map
