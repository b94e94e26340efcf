#pragma once

#include "frontends/haste/tracking/event_window.hpp"
#include "frontends/haste/tracking/footprints.hpp"
#include "frontends/haste/tracking/template.hpp"

namespace evbench::haste {

/// The input of a scoring method: a tracker's window, state and template. Every scoring method has
///   start(input)                      at the start, or to restart at any state,
///   change_to(h, input)               after a change of state to hypothesis h, to which input.grid is set,
///   update(newest, replaced, input)   after an event has replaced another one in the window,
///   raw()                             the scores up to a factor, which is
///   unit(input).
struct ScoringInput {
  const EventWindow& window;
  const GridState& grid;
  const Template& learnt;

  /// An event's index (Footprints::place).
  int place(const Event& event) const { return Footprints::place(event.x - grid.x, event.y - grid.y); }
};

}  // namespace evbench::haste
