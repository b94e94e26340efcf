#include "backends/gp_map/modules/noise_learning.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "core/geometry/seen_point.hpp"
#include "core/geometry/solve_symmetric.hpp"
#include "core/smoother/factors.hpp"
#include "core/support/median.hpp"

namespace evbench::gp_map {
namespace {

constexpr double kMedianNorm = 1.17741;              ///< of a two-dimensional standard normal
constexpr double kDriftBlock = 0.2, kDropped = 1.0;  ///< [s] length of a block; age at which it is dropped
constexpr int kFewestInBlock = 4;                    ///< observations in a block that measures drift
constexpr std::size_t kFewestTracks = 8;
constexpr double kOutlierLossWidth = 2.0;  ///< of the loss against outliers [medians]
constexpr double kBinsPerOctave = 16.0;
constexpr double kLeastShare = 0.01;
constexpr int kAge = 3;  ///< states after which an interval's residuals are used

/// A pose error that changes linearly over an interval, by weighted least squares from its effects on the landmarks'
/// images.
class PoseError {
 public:
  using Rows = Eigen::Matrix<double, 2, 12>;

  void add(const Rows& J, const Vector2& residual, double weight) {
    H_.noalias() += weight * J.transpose() * J;
    g_.noalias() += weight * J.transpose() * residual;
  }
  void solve() { error_ = solve_symmetric(H_, g_); }
  Vector2 at(const Rows& J) const { return J * error_; }

 private:
  Matrix12 H_ = 1e-3 * Matrix12::Identity();  // undetermined components are zero
  Vector12 g_ = Vector12::Zero(), error_ = g_;
};

/// A residual [stated sigmas] and its derivative with respect to the pose at the interval's middle and its rate.
struct Residual {
  int landmark = 0;
  double t = 0.0;
  Vector2 value = Vector2::Zero();
  PoseError::Rows J = PoseError::Rows::Zero();
};

Residual residual_of(const GpInterval& interval, int landmark, const Vector3& position, const Observation& z,
                     const PinholeCamera& camera) {
  Residual result{.landmark = landmark, .t = z.t};
  const Vector3 q = interval.pose(z.t).inverse() * position;
  if (!(q.z() > 0.0)) {
    result.value.setConstant(std::numeric_limits<double>::infinity());
    return result;
  }
  result.value = z.whitening * Vector2(camera.project(q) - z.pixel);
  const Matrix26 J = z.whitening * Matrix26(camera.project_jacobian(q) * seen_point_jacobian(q));
  const double s = 2.0 * (z.t - interval.t0()) / interval.dt() - 1.0;
  result.J << J, s * J;
  return result;
}

}  // namespace

void NoiseLearner::Median::add(double value) {
  constexpr double kSmallest = 1e-9, kLargest = 1e9;
  const double bin = std::round(kBinsPerOctave * std::log2(std::clamp(value, kSmallest, kLargest)));
  weights_[static_cast<int>(bin)] += 1.0;
}

void NoiseLearner::Median::fade(double factor) {
  for (auto& [bin, weight] : weights_) weight *= factor;
}

double NoiseLearner::Median::value() const {
  double half = 0.0;
  for (const auto& [bin, weight] : weights_) half += 0.5 * weight;
  double below = 0.0;
  for (const auto& [bin, weight] : weights_) {
    if (below + weight >= half && weight > 0.0) {
      return std::exp2((bin - 0.5 + (half - below) / weight) / kBinsPerOctave);
    }
    below += weight;
  }
  return 0.0;
}

void NoiseLearner::follow(const FactorGraph& graph, double memory) {
  const int newest = static_cast<int>(graph.states.size()) - 1;
  for (; taken_ < newest - kAge; ++taken_) {
    const double dt = graph.states[index(taken_ + 1)].t - graph.states[index(taken_)].t;
    norms_.fade(std::exp(-dt / memory));
    means_.fade(std::exp(-dt / memory));
    add(graph, taken_ + 1);
  }
}

void NoiseLearner::add(const FactorGraph& graph, int k) {
  const GpInterval interval = graph.interval(k);
  const IntervalObservations& observations = graph.intervals[index(k)];
  const std::size_t tracks = observations.groups().size();
  if (tracks < kFewestTracks) return;
  std::vector<Residual> residuals;
  std::vector<double> norms;
  for (const auto& group : observations.groups()) {
    const Vector3& position = graph.landmarks[index(group.landmark)].position;
    for (const Observation& z : observations.of(group)) {
      const Residual r = residual_of(interval, group.landmark, position, z, graph.camera);
      if (!r.value.allFinite()) continue;
      residuals.push_back(r);
      norms.push_back(r.value.norm());
    }
  }
  if (residuals.empty()) return;
  const RobustLoss loss(RobustLoss::Kind::cauchy, kOutlierLossWidth * median(std::move(norms)));
  PoseError common;
  for (const Residual& r : residuals) common.add(r.J, r.value, loss.weight(r.value.squaredNorm()));
  common.solve();
  std::erase_if(open_, [&](const auto& block) { return block.second.since < interval.t0() - kDropped; });
  const auto n = static_cast<double>(tracks);
  const double correction = std::sqrt(n / (n - 3.0));  // 6 of 2 n components of the means
  for (const Residual& r : residuals) add(r.landmark, r.t, correction * (r.value - common.at(r.J)));
}

void NoiseLearner::add(int landmark, double t, const Vector2& residual) {
  if (!residual.allFinite()) return;
  norms_.add(residual.norm());
  Block& block = open_[landmark];
  if (block.count > 0 && t - block.since > kDriftBlock) {
    if (block.count >= kFewestInBlock) means_.add(block.sum.squaredNorm() / block.count);
    block = Block();
  }
  if (block.count == 0) block.since = t;
  ++block.count;
  block.sum += residual;
}

double NoiseLearner::scale() const {
  const double norm = norms_.value();
  return norm > 0.0 ? norm / kMedianNorm : 1.0;
}

double NoiseLearner::share() const {
  const double single = norms_.value() * norms_.value(), mean = means_.value();
  return mean > 0.0 ? std::clamp(single / mean, kLeastShare, 1.0) : 1.0;
}

double NoiseLearner::scale_of_means() const { return scale() / std::sqrt(share()); }

NoiseLearner learn_noise(const FactorGraph& graph) {
  NoiseLearner result;
  for (int k = 1; k < static_cast<int>(graph.states.size()); ++k) result.add(graph, k);
  return result;
}

RobustLoss NoiseLearner::loss(RobustLoss::Kind kind, double width) const {
  return {kind, width * scale(), share() / (scale() * scale())};
}

}  // namespace evbench::gp_map
