#pragma once

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <string>

namespace evbench {

/// Checks of an option's number, in place of CLI11's, whose messages spell out the largest number there is.
inline CLI::Validator number_check(const std::string& expected, bool (*good)(double)) {
  const auto check = [expected, good](std::string& text) {
    double value = 0.0;
    if (CLI::detail::lexical_cast(text, value) && good(value)) return std::string();
    return fmt::format("{}: expected a number {}", text, expected);
  };
  return {check, "NUMBER " + expected};
}

inline CLI::Validator above_zero() {
  return number_check("above 0", [](double value) { return value > 0.0; });
}
inline CLI::Validator not_negative() {
  return number_check("of at least 0", [](double value) { return value >= 0.0; });
}

}  // namespace evbench
