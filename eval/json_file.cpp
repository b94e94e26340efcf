#include "eval/json_file.hpp"

#include <fmt/format.h>

#include <fstream>
#include <iterator>

#include "core/support/error.hpp"
#include "core/support/json.hpp"
#include "core/support/json_reason.hpp"

namespace evbench {

Json read_json_file(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw InputError(fmt::format("{}: can't be opened", path));
  const std::string text{std::istreambuf_iterator<char>(file), {}};  // parsed faster than a stream
  try {
    return parse_json(text);
  } catch (const Json::exception& error) {
    throw InputError(fmt::format("{}: is not JSON: {}", path, json_reason(error)));
  }
}

std::string json_file_text(const Json& json) { return dump_json(json, 2) + "\n"; }

}  // namespace evbench
