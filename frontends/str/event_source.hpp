#pragma once

#include <cmath>
#include <cstdint>
#include <memory>
#include <string>

#include "core/events/event_stream.hpp"
#include "core/plugin/frontend.hpp"

namespace evbench::str {

inline double seconds(std::int64_t t) { return static_cast<double>(t) / 1e6; }
inline std::int64_t microseconds(double t) { return static_cast<std::int64_t>(std::floor(t * 1e6 + 1e-3)); }

/// The events of a front-end's source; throws InputError, naming the front-end, where there are none.
std::unique_ptr<EventStream> events_of(const FrontEndContext& context, const std::string& frontend);

}  // namespace evbench::str
