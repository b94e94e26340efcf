#pragma once

#include "core/plugin/options.hpp"
#include "core/support/json.hpp"

namespace evbench {

/// Writes all options of a struct as JSON.
template <class Struct>
Json write_options(Struct options) {
  OptionSet set;
  options.declare(set);
  return set.write();
}

}  // namespace evbench
