#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/support/json.hpp"

namespace evbench {

/// What was drawn at random for a run: overrides "KEY=VALUE" of its config, and its properties.
struct Drawn {
  struct Property {
    std::string name, text;
    std::vector<std::string> keys;  ///< what it sets
  };
  std::vector<std::string> overrides;
  std::vector<Property> properties;
};

/// Draws from an object whose items are
///
///   NAME: {TEXT: {KEY: VALUE, ...}, ...}   a property: one of these sets; of K sets each one once in K seeds, from one
///                                          multiple of K to the next
///   KEY: DISTRIBUTION                      a number for a path in the config
///
/// A DISTRIBUTION is {"uniform": [A, B]}, {"log_uniform": [A, B]} (0 < A) or {"whole": [A, B]}, both ends included, and
/// may take the place of a VALUE in a set. Numbers have four significant digits. An item's draw depends on the seed and
/// on its own name and contents alone: other items do not change it. `place` begins messages. Throws InputError for
/// anything else.
Drawn draw(const Json& items, std::uint64_t seed, const std::string& place);

}  // namespace evbench
