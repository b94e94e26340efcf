#include "backends/gp_map/modules/prior_learning.hpp"

#include <algorithm>
#include <cmath>

namespace evbench::gp_map {
namespace {

constexpr double kGuessWeight = 2.0;     ///< degrees of freedom of the estimate over a longer time
constexpr double kCommonWeight = 100.0;  ///< of the estimate from the other axes
constexpr double kBegin = 0.5;           ///< of the initial density, for the time before any evidence
constexpr double kLeast = 1e-9;
constexpr double kHistoryWindow = 0.5;   ///< [s], to both sides
constexpr double kUpdateInterval = 0.1;  ///< [s] between two updates of the evidence
constexpr double kUpdated = 0.4;         ///< [s] whose evidence is updated
constexpr int kMostUpdated = 16;         ///< intervals
constexpr int kReset = 8;                ///< newest intervals whose density is set
constexpr double kForce = 1.0;           ///< an expansion that changes by more is set
constexpr double kDensityChange = 1.5;   ///< a density that changes by a larger factor is set

/// Evidence of the intervals from `first` on; none if the system is singular.
std::vector<PriorEvidence> evidence_from(Smoother& smoother, int first) {
  std::vector<PriorEvidence> result;
  const FactorGraph& graph = smoother.graph();
  for (const PairMatrix& joint : smoother.chain_covariances(first)) {
    const int k = first + static_cast<int>(result.size());
    result.push_back(evidence_of(graph.interval(k), joint, graph.qcs[index(k)]));
  }
  return result;
}

}  // namespace

PriorEvidence evidence_of(const GpInterval& interval, const PairMatrix& joint, const Vector6& qc) {
  const GpInterval::PriorJacobians jacobians = interval.prior_jacobians(interval.derivatives());
  const int orders = interval.prior().orders();
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, 18, 36> J(6 * orders, 12 * orders);
  J << jacobians.J0, jacobians.J1;
  const StateMatrix covariance = J * joint * J.transpose();
  const StateVector e = interval.prior_residual();
  const Eigen::MatrixXd W = interval.prior_information_of_axis();
  PriorEvidence result;
  result.t = interval.t0() + 0.5 * interval.dt();
  for (int i = 0; i < 6; ++i) {
    double trace = 0.0;
    const auto add = [&](int r, int c, double weight) {
      result.square[i] += weight * e[i + 6 * c] * e[i + 6 * r];
      trace += weight * covariance(i + 6 * c, i + 6 * r);
    };
    for (int r = 0; r < orders; ++r) {
      for (int c = 0; c < r; ++c) add(r, c, 2.0 * W(r, c));
    }
    for (int r = 0; r < orders; ++r) add(r, r, W(r, r));
    result.freedom[i] = std::clamp(orders - trace / qc[i], 0.0, 1.0 * orders);
  }
  return result;
}

void PriorEvidence::add(const PriorEvidence& other, double window) {
  const double weight = std::exp(-std::abs(t - other.t) / window);
  square += weight * other.square;
  freedom += weight * other.freedom;
}

Vector6 PriorEvidence::qc(const Vector6& guess, double weight) const {
  return (square + weight * guess).cwiseQuotient((freedom.array() + weight).matrix()).cwiseMax(kLeast);
}

Vector6 PriorEvidence::common_qc(const Vector6& guess, double weight) const {
  Vector6 result;
  for (const int kind : {0, 3}) {
    result.segment<3>(kind).setConstant((square.segment<3>(kind).sum() + weight * guess.segment<3>(kind).mean()) /
                                        (freedom.segment<3>(kind).sum() + weight));
  }
  return result;
}

double PriorEvidence::expansion(const Vector6& qc) const { return square.tail<3>().cwiseQuotient(qc.tail<3>()).sum(); }

void RecentPrior::take(int first, const std::vector<PriorEvidence>& evidence) {
  if (evidence.empty()) return;
  recent_.erase(recent_.upper_bound(first + static_cast<int>(evidence.size()) - 1), recent_.end());  // removed states
  for (std::size_t i = 0; i < evidence.size(); ++i) recent_[first + static_cast<int>(i)] = evidence[i];
  for (; !recent_.empty() && recent_.begin()->first < first; recent_.erase(recent_.begin())) {
    PriorEvidence older = recent_.begin()->second, remembered = older;
    older.add(older_, window_);
    remembered.add(remembered_, memory_);
    older_ = older;
    remembered_ = remembered;
  }
}

Vector6 RecentPrior::at(double t) const {
  PriorEvidence window{t, Vector6::Zero(), Vector6::Zero()}, memory = window;
  window.add(older_, window_);
  memory.add(remembered_, memory_);
  for (const auto& [k, evidence] : recent_) {
    window.add(evidence, window_);
    memory.add(evidence, memory_);
  }
  return window.qc(memory.qc(memory.common_qc(guess_, kBegin), kCommonWeight), kGuessWeight);
}

void PriorLearner::follow(Smoother& smoother) {
  const FactorGraph& graph = smoother.graph();
  const double now = graph.states.back().t;
  if (now < followed_until_ + kUpdateInterval) return;
  followed_until_ = now;
  if (!prior_) prior_.emplace(window_, memory_, graph.qc);
  take_evidence(smoother);
  if (prior_->recent().empty()) return;
  const int newest = static_cast<int>(graph.states.size()) - 1;
  for (const auto& [k, evidence] : prior_->recent()) {
    if (k <= newest - kReset) continue;
    const Vector6 qc = prior_->at(evidence.t), change = qc.cwiseQuotient(graph.qcs[index(k)]);
    const double expansion = evidence.expansion(qc);
    if (change.maxCoeff() > kDensityChange || change.minCoeff() < 1.0 / kDensityChange ||
        std::abs(expansion - graph.expansions[index(k)]) > kForce) {
      smoother.set_qc(k, qc, expansion);
    }
  }
  smoother.set_next_qc(prior_->at(now));
}

void PriorLearner::take_evidence(Smoother& smoother) {
  const FactorGraph& graph = smoother.graph();
  const int newest = static_cast<int>(graph.states.size()) - 1;
  int first = 1;  // all intervals of the initial map
  if (!prior_->recent().empty()) {
    first = newest;
    const double from = graph.states.back().t - kUpdated;
    while (first > 1 && newest - first + 1 < kMostUpdated && graph.states[index(first - 1)].t > from) --first;
  }
  first = std::max(first, smoother.first_state() + 1);
  prior_->take(first, evidence_from(smoother, first));
}

std::vector<double> surplus_expansions(Smoother& smoother) {
  const FactorGraph& graph = smoother.graph();
  std::vector<double> surplus(graph.states.size(), 0.0);
  std::size_t k = index(smoother.first_state()) + 1;
  for (const PriorEvidence& one : evidence_from(smoother, static_cast<int>(k))) {
    surplus[k] = graph.expansions[k] - one.expansion(graph.qcs[k]);
    ++k;
  }
  return surplus;
}

void learn_prior(Smoother& smoother, const TimeSpan& span, std::span<const double> surplus) {
  const int first = std::max(smoother.first_state() + 1, smoother.graph().first_state_after(span.from));
  const std::vector<PriorEvidence> evidence = evidence_from(smoother, first);
  PriorEvidence all;
  for (const PriorEvidence& one : evidence) {
    all.square += one.square;
    all.freedom += one.freedom;
  }
  const Vector6 mean = all.qc(all.common_qc(smoother.graph().qc, kBegin), kCommonWeight);
  // Sums over the intervals before and the intervals after, accumulated in both directions.
  std::vector<PriorEvidence> before = evidence, after = evidence;
  for (std::size_t k = 1; k < evidence.size(); ++k) before[k].add(before[k - 1], kHistoryWindow);
  for (std::size_t k = evidence.size(); k-- > 1;) after[k - 1].add(after[k], kHistoryWindow);
  for (std::size_t k = 0; k < evidence.size() && evidence[k].t <= span.until; ++k) {
    PriorEvidence sum = before[k];
    sum.square += after[k].square - evidence[k].square;
    sum.freedom += after[k].freedom - evidence[k].freedom;
    const Vector6 qc = sum.qc(mean, kGuessWeight);
    const std::size_t i = index(first) + k;
    const double expansion = evidence[k].expansion(qc) + (surplus.empty() ? 0.0 : surplus[i]);
    smoother.set_qc(static_cast<int>(i), qc, std::max(0.0, expansion));
  }
}

}  // namespace evbench::gp_map
