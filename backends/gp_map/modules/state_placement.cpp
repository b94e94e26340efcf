#include "backends/gp_map/modules/state_placement.hpp"

#include <algorithm>

#include "core/support/median.hpp"

namespace evbench::gp_map {

void PlacementOptions::declare(OptionSet& set) {
  set.add("rule", rule, {"rate", "observations", "motion", "prediction"},
          "rate: evenly in time; observations: after a number of observations; motion: when the tracks have moved; "
          "prediction: when the landmarks are seen off what the motion prior predicts");
  set.add("rate", rate, "rule \"rate\": control states per second [Hz]").range(0.5, 1000.0);
  set.add("observations", observations, "rule \"observations\": observations between two control states").range(1);
  set.add("motion", motion,
          "rule \"motion\": median distance of the tracks' newest observations from their last one before the newest "
          "control state [px]")
      .above(0.0);
  set.add("deviation", deviation,
          "rule \"prediction\": median distance of the landmarks from their prediction with the newest control state's "
          "velocity; interpolation between two states errs by about an eighth of it [sigmas of the observations]")
      .above(0.0);
  set.add("min_spacing", min_spacing, "all rules but \"rate\": least time between two [s]").range(1e-3, 10.0);
  set.add("max_spacing", max_spacing,
          "all rules but \"rate\": greatest time between two, unless min_spacing is larger [s]")
      .range(1e-3, 10.0);
}

void StatePlacement::observe(const UndistortedObservation& observation) {
  if (!first_) first_ = observation.t;
  last_observation_ = observation.t;
  if (options_.rule != Rule::rate) later_.push_back(observation);
}

std::optional<double> StatePlacement::next(double now) {
  if (!first_) return std::nullopt;
  const bool by_data = newest_ && options_.rule != Rule::rate;
  const double t = by_data ? time_by_data() : upcoming();
  if (t > now) return std::nullopt;
  place(t);
  return t;
}

double StatePlacement::upcoming() const {
  if (!newest_) return *first_;
  return options_.rule == Rule::rate ? *first_ + static_cast<double>(placed_) / options_.rate : latest();
}

double StatePlacement::time_by_data() {
  while (!enough_ && !later_.empty() && later_.front().t <= latest()) {
    consider(later_.front());
    if (is_enough()) enough_ = later_.front().t;
    later_.pop_front();
  }
  return std::clamp(enough_.value_or(latest()), earliest(), latest());
}

void StatePlacement::consider(const UndistortedObservation& observation) {
  ++count_;
  if (options_.rule == Rule::prediction) {
    const std::optional<double> deviation = deviation_(observation);
    if (!deviation) return;
    bool& deviates = deviates_[observation.track];
    deviating_ -= deviates;
    deviates = *deviation > options_.deviation;
    deviating_ += deviates;
  }
  if (options_.rule != Rule::motion) return;
  Displacement& track = displacements_.try_emplace(observation.track, Displacement{observation.pixel}).first->second;
  track.to = observation.pixel;
  track.t = observation.t;
}

bool StatePlacement::is_enough() const {
  if (options_.rule == Rule::observations) return count_ >= options_.observations;
  constexpr int kFewest = 6;  // tracks for a majority
  if (options_.rule == Rule::prediction) {
    return std::ssize(deviates_) >= kFewest && 2 * deviating_ > std::ssize(deviates_);
  }
  std::vector<double> distances;
  for (const auto& [id, track] : displacements_) distances.push_back((track.to - track.from).norm());
  return !distances.empty() && median(std::move(distances)) >= options_.motion;
}

void StatePlacement::place(double t) {
  for (; !later_.empty() && later_.front().t <= t; later_.pop_front()) consider(later_.front());
  for (auto& [id, track] : displacements_) track.from = track.to;
  std::erase_if(displacements_, [&](const auto& track) { return track.second.t < t - options_.max_spacing; });
  newest_ = t;
  ++placed_;
  count_ = 0;
  deviates_.clear();
  deviating_ = 0;
  enough_.reset();
}

std::optional<double> StatePlacement::last() {
  if (!newest_ || *newest_ >= *last_observation_) return std::nullopt;
  const double t = options_.rule == Rule::rate ? upcoming() : std::max(*last_observation_, earliest());
  place(t);
  return t;
}

}  // namespace evbench::gp_map
