#include "backends/bundle_adjustment/frames.hpp"

#include <algorithm>
#include <cmath>

namespace evbench::bundle_adjustment {

Frame FrameBuilder::close(double end) {
  struct Sum {
    Vector2 pixel = Vector2::Zero();
    double variance = 0.0, count = 0.0;
  };
  std::map<TrackId, Sum> sums;
  double time = 0.0;
  for (const TrackObservation& z : gathered_) {
    Sum& sum = sums[z.track];
    sum.pixel += z.pixel;
    sum.variance += z.sigma * z.sigma;
    sum.count += 1.0;
    time += z.t - *start_;
  }
  Frame frame;
  frame.t = *start_ + time / static_cast<double>(gathered_.size());
  for (const auto& [track, sum] : sums) {
    const double variance = sum.variance / sum.count;
    const double common = std::min(variance, rule_.common_noise_px * rule_.common_noise_px);
    frame.keypoints.push_back({track, sum.pixel / sum.count, std::sqrt(common + (variance - common) / sum.count)});
  }
  gathered_.clear();
  start_ = end;
  return frame;
}

std::vector<Frame> FrameBuilder::add(std::span<const TrackObservation> observations) {
  std::vector<Frame> frames;
  for (const TrackObservation& z : observations) {
    if (!start_) start_ = z.t;
    if (rule_.observations > 0) {
      gathered_.push_back(z);
      if (static_cast<int>(gathered_.size()) == rule_.observations) frames.push_back(close(z.t));
      continue;
    }
    for (Frame& frame : advance(z.t)) frames.push_back(std::move(frame));
    gathered_.push_back(z);
  }
  return frames;
}

std::vector<Frame> FrameBuilder::advance(double t) {
  std::vector<Frame> frames;
  if (rule_.observations > 0 || !start_) return frames;
  if (!gathered_.empty() && *start_ + rule_.duration <= t) frames.push_back(close(*start_ + rule_.duration));
  // Frames without observations are none: the next one starts where the grid stands at t.
  if (gathered_.empty()) *start_ += rule_.duration * std::max(0.0, std::floor((t - *start_) / rule_.duration));
  return frames;
}

std::optional<Frame> FrameBuilder::rest() {
  if (gathered_.empty()) return std::nullopt;
  const double last = gathered_.back().t;
  const bool half = rule_.observations > 0 ? 2 * static_cast<int>(gathered_.size()) >= rule_.observations
                                           : last - *start_ >= 0.5 * rule_.duration;
  if (!half) return std::nullopt;
  return close(last);
}

}  // namespace evbench::bundle_adjustment
