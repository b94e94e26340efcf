#include "backends/gp_map/noise_learning.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <vector>

#include "backends/gp_map/factors.hpp"

namespace evbench::gp_map {
namespace {

constexpr double kMedianNorm = 1.17741;           ///< of a two-dimensional standard normal
constexpr double kBlock = 0.2, kForgotten = 1.0;  ///< [s]
constexpr int kFewest = 4;                        ///< observations in a block that tells of drift
constexpr std::size_t kFewestTracks = 6;
constexpr double kBinsPerOctave = 16.0;
constexpr double kLeastShare = 0.01;
constexpr int kAge = 3;  ///< states after which an interval's residuals are looked at

/// A vector field over the image, affine, by weighted least squares.
class AffineField {
 public:
  void add(const Vector2& place, const Vector2& value, double weight) {
    const Vector3 row(1.0, place.x(), place.y());
    H_ += weight * row * row.transpose();
    g_ += weight * row * value.transpose();
  }
  void solve() { field_ = H_.ldlt().solve(g_); }
  Vector2 at(const Vector2& place) const { return field_.transpose() * Vector3(1.0, place.x(), place.y()); }

 private:
  Matrix3 H_ = 1e-3 * Matrix3::Identity();  // tracks on one point or line leave it determined
  Eigen::Matrix<double, 3, 2> g_ = Eigen::Matrix<double, 3, 2>::Zero(), field_ = g_;
};

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
  struct Residual {
    int landmark;
    double t;
    Vector2 place, value;
  };
  const GpInterval interval(graph.states[index(k - 1)], graph.states[index(k)]);
  const IntervalObservations& observations = graph.intervals[index(k)];
  const std::size_t tracks = observations.groups().size();
  if (tracks < kFewestTracks) return;
  std::vector<Residual> residuals;
  AffineField common;
  for (const auto& group : observations.groups()) {
    const Vector3& landmark = graph.landmarks[index(group.landmark)].position;
    for (const Observation& z : observations.of(group)) {
      const Vector2 place((z.pixel.x() - graph.camera.cx) / graph.camera.fx,
                          (z.pixel.y() - graph.camera.cy) / graph.camera.fy);
      const Vector2 value = reprojection_residual(interval, landmark, z, graph.camera);
      residuals.push_back({group.landmark, z.t, place, value});
      common.add(place, value, graph.loss.weight(value.squaredNorm()) / graph.loss.share());
    }
  }
  common.solve();
  std::erase_if(open_, [&](const auto& block) { return block.second.since < interval.t0() - kForgotten; });
  const auto n = static_cast<double>(tracks);
  const double taken_away = std::sqrt(n / (n - 3.0));
  for (const Residual& r : residuals) add(r.landmark, r.t, taken_away * (r.value - common.at(r.place)));
}

void NoiseLearner::add(int landmark, double t, const Vector2& residual) {
  if (!residual.allFinite()) return;
  norms_.add(residual.norm());
  Block& block = open_[landmark];
  if (block.count > 0 && t - block.since > kBlock) {
    if (block.count >= kFewest) means_.add(block.sum.squaredNorm() / block.count);
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

RobustLoss NoiseLearner::loss(RobustLoss::Kind kind, double width) const {
  return {kind, width * scale(), share() / (scale() * scale())};
}

}  // namespace evbench::gp_map
