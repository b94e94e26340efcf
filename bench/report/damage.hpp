#pragma once

#include <string>
#include <vector>

#include "core/support/error.hpp"
#include "core/support/json.hpp"
#include "core/support/json_reason.hpp"

namespace evbench::report {

/// Does a part of the page; where files are damaged, adds the reason to `damage`.
template <class Make>
void attempt(std::vector<std::string>& damage, const Make& make) {
  try {
    make();
  } catch (const InputError& error) {
    damage.emplace_back(error.what());
  } catch (const Json::exception& error) {
    damage.emplace_back("metrics.json: " + json_reason(error));
  }
}

}  // namespace evbench::report
