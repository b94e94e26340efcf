#pragma once

#include <array>
#include <cstdint>
#include <deque>

#include "core/events/event.hpp"
#include "frontends/haste/tracking/tracker.hpp"

namespace evbench::haste::testing {

/// A direct transcription of the published rules, one hypothesis, one event and one cell at a time: the reference that
/// Tracker is tested against. It rounds where Tracker's header says. It shares with Tracker the hypotheses, the
/// position of an event in a patch (footprint()) and the events' weights.
class PlainTracker {
 public:
  PlainTracker(const TrackerOptions& options, const GridState& seed) : options_(options), grid_(seed) {}

  Tracker::Update push(const Event& event);

  const GridState& grid_state() const { return grid_; }
  std::int64_t t() const { return t_; }
  /// The same numbers as Tracker::scores().
  const Scores& scores() const { return scores_; }

 private:
  template <class Number>
  using Patch = std::array<std::array<Number, kPatchSize>, kPatchSize>;  ///< by row and column

  Footprint footprint_of(const Event& event, const GridState& grid) const;
  void learn(const Event& event, double weight);
  Patch<std::int64_t> quantised_template() const;
  float sample(const Event& event, const GridState& grid) const;
  Patch<std::int64_t> difference(const GridState& grid, const Patch<std::int64_t>& scaled_template) const;

  void initialise_hypotheses();
  void append(const Event& event);
  void update_scores(const Event& oldest);
  void weigh_samples();
  void add_to_difference(std::size_t h, const Event& event, int sign);
  std::size_t best_hypothesis() const;
  void scale_scores();

  TrackerOptions options_;
  GridState grid_;
  std::int64_t t_ = 0;
  bool running_ = false;
  std::deque<Event> window_;
  Patch<float> template_{};
  double mass_ = 0.0;
  std::array<double, kHypotheses> raw_{};  ///< the scores, whole numbers but for the weighted correlations
  Scores scores_;
  std::deque<std::array<float, kHypotheses>> samples_;          ///< haste_correlation
  Patch<std::int64_t> quantised_{};                             ///< haste_correlation_star
  std::array<Patch<std::int64_t>, kHypotheses> differences_{};  ///< haste_difference_star
};

}  // namespace evbench::haste::testing
