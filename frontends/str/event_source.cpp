#include "frontends/str/event_source.hpp"

#include <fmt/format.h>

#include "core/support/error.hpp"

namespace evbench::str {

std::unique_ptr<EventStream> events_of(const FrontEndContext& context, const std::string& frontend) {
  auto events = context.source.events();
  if (!events) {
    throw InputError(
        fmt::format("{}: {} works on events, and this source has none; expected a recording of events or the source "
                    "event_simulation",
                    context.place, frontend));
  }
  return events;
}

}  // namespace evbench::str
