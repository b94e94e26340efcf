#include "backends/bundle_adjustment/batches.hpp"

#include <algorithm>
#include <cmath>

#include "core/support/median.hpp"

namespace evbench::bundle_adjustment {

void BatchBuilder::gather(const UndistortedObservation& z) {
  gathered_.push_back(z);
  shifts_.try_emplace(z.track, Shift{z.pixel, z.pixel}).first->second.to = z.pixel;
}

bool BatchBuilder::is_full() const {
  if (rule_.observations > 0) return static_cast<int>(gathered_.size()) == rule_.observations;
  return rule_.motion_px > 0.0 && gathered_.back().t - *start_ >= rule_.shortest_duration &&
         median_shift() >= rule_.motion_px;
}

/// Median shift of the batch's tracks since they entered it.
double BatchBuilder::median_shift() const {
  std::vector<double> distances;
  for (const auto& [track, shift] : shifts_) distances.push_back((shift.to - shift.from).norm());
  return distances.empty() ? 0.0 : median(std::move(distances));
}

Batch BatchBuilder::close(double end) {
  struct Sum {
    Vector2 pixel = Vector2::Zero();
    Matrix2 covariance = Matrix2::Zero();
    double count = 0.0;
  };
  std::map<TrackId, Sum> sums;
  double time = 0.0;
  for (const UndistortedObservation& z : gathered_) {
    Sum& sum = sums[z.track];
    sum.pixel += z.pixel;
    sum.covariance += z.noise.covariance();
    sum.count += 1.0;
    time += z.t - *start_;
  }
  Batch batch;
  batch.t = *start_ + time / static_cast<double>(gathered_.size());
  batch.end = end;
  for (const auto& [track, sum] : sums) {
    const PixelNoise single(Matrix2(sum.covariance / sum.count));
    const double sigma = single.sigma();
    const double common = std::min(1.0, rule_.common_noise_px * rule_.common_noise_px / (sigma * sigma));
    const PixelNoise mean = single.scaled(std::sqrt(common + (1.0 - common) / sum.count));
    batch.keypoints.push_back({track, sum.pixel / sum.count, mean});
  }
  gathered_.clear();
  shifts_.clear();
  start_ = end;
  return batch;
}

std::vector<Batch> BatchBuilder::add(std::span<const UndistortedObservation> observations) {
  std::vector<Batch> batches;
  for (const UndistortedObservation& z : observations) {
    if (!start_) start_ = z.t;
    for (Batch& batch : advance(z.t)) batches.push_back(std::move(batch));
    gather(z);
    if (is_full()) batches.push_back(close(z.t));
  }
  return batches;
}

std::vector<Batch> BatchBuilder::advance(double t) {
  std::vector<Batch> batches;
  if (rule_.observations > 0 || !start_) return batches;
  if (!gathered_.empty() && *start_ + rule_.duration <= t) batches.push_back(close(*start_ + rule_.duration));
  // There are no batches without observations: the next one starts at the last grid point up to t.
  if (gathered_.empty()) *start_ += rule_.duration * std::max(0.0, std::floor((t - *start_) / rule_.duration));
  return batches;
}

std::optional<Batch> BatchBuilder::rest() {
  if (gathered_.empty()) return std::nullopt;
  const double last = gathered_.back().t;
  const bool half = rule_.observations > 0 ? 2 * static_cast<int>(gathered_.size()) >= rule_.observations
                                           : last - *start_ >= 0.5 * rule_.duration ||
                                                 (rule_.motion_px > 0.0 && median_shift() >= 0.5 * rule_.motion_px);
  if (!half) return std::nullopt;
  return close(last);
}

}  // namespace evbench::bundle_adjustment
