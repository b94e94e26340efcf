#pragma once

#include <fmt/format.h>

#include <functional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace evbench::battery {

/// A check that every plugin of a kind must pass.
struct Check {
  std::string name;           ///< a sentence without its subject, the plugin: "survives a gap ..."
  std::function<void()> run;  ///< throws Failure, or whatever the plugin throws, if it fails
};

/// The reason why a plugin fails a check.
class Failure : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Throws a Failure with the formatted sentence unless the condition holds.
template <class... Values>
void require(bool condition, fmt::format_string<Values...> text, Values&&... values) {
  if (!condition) throw Failure(fmt::format(text, std::forward<Values>(values)...));
}

}  // namespace evbench::battery
