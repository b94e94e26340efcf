#pragma once

#include <fmt/format.h>

#include <cstdio>
#include <string>
#include <vector>

#include "core/support/error.hpp"

namespace evbench {

/// What went wrong with some of many, told when the others are done: prints all messages but the last, which is thrown
/// as an InputError. Nothing where there are none.
inline void throw_together(const std::vector<std::string>& messages) {
  if (messages.empty()) return;
  for (std::size_t i = 0; i + 1 < messages.size(); ++i) fmt::print(stderr, "evbench: {}\n", messages[i]);
  throw InputError(messages.back());
}

}  // namespace evbench
