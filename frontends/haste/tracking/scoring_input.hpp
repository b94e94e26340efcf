#pragma once

#include "frontends/haste/tracking/event_window.hpp"
#include "frontends/haste/tracking/footprints.hpp"
#include "frontends/haste/tracking/template.hpp"

namespace evbench::haste {

/// What hypotheses are scored by: a tracker's window, state and template. Every way of scoring has
///   start(input)                      at the start, or anew anywhere,
///   change_to(h, input)               after a change of state to hypothesis h, to which input.grid is set,
///   update(newest, replaced, input)   after an event has come into the window in the place of another,
///   raw()                             the scores up to a factor, which is
///   unit(input).
struct ScoringInput {
  const EventWindow& window;
  const GridState& grid;
  const Template& learnt;

  /// Where an event is (Footprints::place).
  int place(const Event& event) const { return Footprints::place(event.x - grid.x, event.y - grid.y); }
};

}  // namespace evbench::haste
