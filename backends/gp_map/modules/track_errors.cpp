#include "backends/gp_map/modules/track_errors.hpp"

#include <algorithm>
#include <cmath>

#include "core/smoother/factors.hpp"
#include "core/support/median.hpp"

namespace evbench::gp_map {
namespace {

constexpr double kErrorBlock = 0.15;       ///< [s]
constexpr int kFewestInLastBlock = 4;      ///< observations in the last block, which may be incomplete
constexpr double kMedianSquare = 1.38629;  ///< of a two-dimensional standard normal
constexpr double kOthers = 3.0;            ///< weight of the noise of all tracks, in blocks

}  // namespace

TrackErrors::TrackErrors(const FactorGraph& graph, int landmark, double usual, const TimeSpan& span) {
  const FactorGraph::Landmark& l = graph.landmarks[index(landmark)];
  std::optional<Vector2> before;
  for_each_observation(graph, landmark, span, [&](const GpInterval& interval, const Observation& z) {
    if (!span.has(z.t)) return;
    if (before == z.pixel) return;  // a stationary camera: a repeated observation has the same error again
    before = z.pixel;
    if (blocks_.empty() || z.t > blocks_.back().since + kErrorBlock) blocks_.push_back({.since = z.t});
    ++blocks_.back().count;
    blocks_.back().sum += l.sigma_scale * reprojection_residual(interval, l.position, z, graph.camera);
  });
  if (!blocks_.empty() && blocks_.back().count < kFewestInLastBlock) blocks_.pop_back();
  for (Block& block : blocks_) block.square = block.sum.squaredNorm() / (block.count * usual * usual);
}

std::vector<double> TrackErrors::squares() const {
  std::vector<double> squares;
  for (const Block& block : blocks_) squares.push_back(block.square);
  return squares;
}

double TrackErrors::sigma_scale() const {
  if (blocks_.empty()) return 1.0;
  const auto n = static_cast<double>(blocks_.size());
  const double own = median(squares()) / kMedianSquare;
  return std::sqrt(std::max(1.0, (kOthers + n * own) / (kOthers + n)));
}

bool TrackErrors::is_outlier(double threshold) const {
  const auto far = std::ranges::count_if(blocks_, [&](const Block& b) { return b.square > threshold * threshold; });
  return 2 * far > std::ssize(blocks_);
}

std::optional<double> TrackErrors::drifts_from(double threshold) const {
  std::size_t good = blocks_.size();
  while (good > 0 && blocks_[good - 1].square > threshold * threshold) --good;
  if (good == 0 || good == blocks_.size()) return std::nullopt;
  return blocks_[good].since;
}

LandmarkErrors errors_of_landmarks(const FactorGraph& graph, const NoiseLearner& noise, const TimeSpan& span,
                                   double seen, double begun) {
  const double usual = noise.scale_of_means();
  LandmarkErrors errors;
  for (int j = 0; j < std::ssize(graph.landmarks); ++j) {
    const std::vector<int>& intervals = graph.landmarks[index(j)].intervals;
    if (intervals.empty() || graph.states[index(intervals.back())].t <= seen) continue;
    if (graph.states[index(intervals.front())].t <= begun) continue;
    errors.emplace_back(j, TrackErrors(graph, j, usual, span));
  }
  return errors;
}

}  // namespace evbench::gp_map
