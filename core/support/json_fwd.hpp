#pragma once

#include <nlohmann/json_fwd.hpp>

namespace evbench {

/// Keys keep the order in which they were added. Its members: core/support/json.hpp.
using Json = nlohmann::ordered_json;

}  // namespace evbench
