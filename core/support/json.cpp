#include "core/support/json.hpp"

namespace evbench {

Json parse_json(std::string_view text) { return Json::parse(text); }

Json try_parse_json(std::string_view text) { return Json::parse(text, nullptr, false); }

std::string dump_json(const Json& json, int indent) { return json.dump(indent); }

std::string printable_json(const Json& json) { return json.dump(-1, ' ', false, Json::error_handler_t::replace); }

}  // namespace evbench
