#pragma once

#include <nlohmann/json_fwd.hpp>

namespace evbench {

/// JSON whose keys keep their order of insertion. Include core/support/json.hpp to use its members.
using Json = nlohmann::ordered_json;

}  // namespace evbench
