#include "core/plugin/status.hpp"

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

}  // namespace evbench
