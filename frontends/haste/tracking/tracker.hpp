#pragma once

#include <variant>

#include "core/events/event.hpp"
#include "frontends/haste/tracking/change.hpp"
#include "frontends/haste/tracking/difference.hpp"
#include "frontends/haste/tracking/event_window.hpp"
#include "frontends/haste/tracking/star_correlation.hpp"
#include "frontends/haste/tracking/template.hpp"
#include "frontends/haste/tracking/tracker_options.hpp"
#include "frontends/haste/tracking/weighted_correlation.hpp"

namespace evbench::haste {

/// The weight of the i-th event of a window (the 0th is the oldest) in a template and a score.
float event_weight(Variant variant, int i);

/// Follows one point through the events around it (Alzugaray and Chli: "Asynchronous Multi-Hypothesis Tracking of
/// Features with Event Cameras", 3DV 2019; "HASTE: multi-Hypothesis Asynchronous Speeded-up Tracking of Events", BMVC
/// 2020). The last kWindowSize events in range are compared with a template under several hypotheses: the tracker at
/// its present state, one pixel off, or turned by one step. When one hypothesis is better than the present state by a
/// margin, the tracker moves there. Polarity is ignored. The template is made of the first full window, unless one is
/// given, and is updated slowly.
///
/// States are whole pixels and whole steps of angle. A seed between them keeps its remainder: the patch is at the
/// nearest pixel, and the reported position always has the offset that the seed had.
///
/// A tracker does not know the image size: near or beyond the border it goes on with the events that there are, and the
/// caller ends it. Trackers share no mutable state. No allocation after construction.
///
/// Scores are sums of integers (Footprints), or of products that are exact in double and added in the window's order.
/// So they do not depend on the width of vectors or on the compiler's choice of multiply-add, and equal those of the
/// plain transcription of the published rules in testing/ bit by bit. The published code works in float; here positions
/// in the patch are rounded to 1/32 of a cell, and star variants' templates to 1/8192 of an event.
class Tracker {
 public:
  enum class Update {
    out_of_range,  ///< the event is out of range and ignored
    collecting,    ///< the window is not full yet
    started,       ///< the window is full now
    regular,       ///< the state has not changed
    changed,       ///< the state has changed
  };

  /// Starts at a seed, whose time is ignored. Events must come in time order.
  Tracker(const TrackerOptions& options, const TrackerState& seed);
  /// Starts where a point with a known template is seen again.
  Tracker(const TrackerOptions& options, const TrackerState& seed, const Template& given);

  Update push(const Event& event) {
    return in_range(event.x - grid_.x, event.y - grid_.y) ? take(event) : Update::out_of_range;
  }

  bool running() const { return running_; }  ///< whether its window has been full
  const TrackerState& state() const { return state_; }
  const GridState& grid_state() const { return grid_; }
  Scores scores() const;  ///< the newest; all zero until it runs
  /// The newest change of state, or start; its `tracker` is −1.
  const Change& change() const { return change_; }
  std::int64_t event_count() const { return event_count_; }  ///< in range so far
  const EventWindow& window() const { return window_; }
  /// Empty until it runs, unless one was given.
  Template learnt_template() const;

 private:
  ScoringInput input() const { return {window_, grid_, learnt_}; }
  Update take(const Event& event);
  void start();
  void change_to(std::size_t h);
  void learn_waiting(int end);
  void set_grid(const GridState& grid, std::int64_t t);

  TrackerOptions options_;
  GridState grid_;
  Vector2 remainder_;       ///< of the position, beyond the grid
  double angle_remainder_;  ///< of the angle, beyond the grid
  TrackerState state_;
  bool running_ = false, template_given_ = false;
  std::int64_t event_count_ = 0;
  EventWindow window_;
  Template learnt_;
  int waiting_ = 0;  ///< events up to the middle one not in the template yet, all at the present state
  std::variant<StarCorrelation, WeightedCorrelation, Difference> scoring_;
  Change change_;
};

}  // namespace evbench::haste
