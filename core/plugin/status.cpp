#include "core/plugin/status.hpp"

#include "core/plugin/exchange.hpp"

namespace evbench {

std::string to_string(RunState state) {
  switch (state) {
    case RunState::ok: return "ok";
    case RunState::degraded: return "degraded";
    case RunState::lost: return "lost";
    case RunState::failed: break;
  }
  return "failed";
}

std::string to_string(TrackingState state) {
  switch (state) {
    case TrackingState::no_map: return "no map yet";
    case TrackingState::tracking: return "tracking";
    case TrackingState::stationary: return "stationary";
    case TrackingState::degraded: return "degraded";
    case TrackingState::lost: break;
  }
  return "lost";
}

}  // namespace evbench
