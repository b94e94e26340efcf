#include "backends/gp_map/state_placement.hpp"

#include <algorithm>

namespace evbench::gp_map {

void StatePlacement::observe(double t) {
  if (!first_) first_ = t;
  last_observation_ = t;
  if (!newest_ || t > *newest_) times_.push_back(t);
}

std::optional<double> StatePlacement::by_rate(double now) const {
  const double t = *first_ + static_cast<double>(count_) / options_.rate;
  return t <= now ? std::optional(t) : std::nullopt;
}

std::optional<double> StatePlacement::by_observations(double now) const {
  if (count_ == 0) return *first_ <= now ? first_ : std::nullopt;
  const double earliest = *newest_ + options_.min_spacing;
  const double latest = *newest_ + std::max(options_.min_spacing, options_.max_spacing);
  const auto wanted = static_cast<std::size_t>(options_.observations);
  const double enough = times_.size() >= wanted ? times_[wanted - 1] : latest;
  const double t = std::clamp(enough, earliest, latest);
  return t <= now ? std::optional(t) : std::nullopt;
}

void StatePlacement::place(double t) {
  newest_ = t;
  ++count_;
  times_.erase(times_.begin(), std::upper_bound(times_.begin(), times_.end(), t));
}

std::optional<double> StatePlacement::next(double now) {
  if (!first_) return std::nullopt;
  const std::optional<double> t = options_.rule == "rate" ? by_rate(now) : by_observations(now);
  if (t) place(*t);
  return t;
}

std::optional<double> StatePlacement::last() {
  if (!newest_ || *newest_ >= *last_observation_) return std::nullopt;
  const double t = options_.rule == "rate" ? *first_ + static_cast<double>(count_) / options_.rate
                                           : std::max(*last_observation_, *newest_ + options_.min_spacing);
  place(t);
  return t;
}

}  // namespace evbench::gp_map
