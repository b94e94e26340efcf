#pragma once

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <charconv>
#include <string>

namespace evbench {

/// Checks of an option's number, in place of CLI11's, whose messages spell out the largest number there is. `name`: in
/// help texts.
inline CLI::Validator number_check(const std::string& name, const std::string& expected, bool (*good)(double)) {
  const auto check = [expected, good](const std::string& text) {
    double value = 0.0;
    const char* const end = text.data() + text.size();
    const auto [read, error] = std::from_chars(text.data(), end, value);
    if (error == std::errc() && read == end && good(value)) return std::string();
    return fmt::format("{}: expected a number {}", text, expected);
  };
  return {check, name};
}

inline CLI::Validator above_zero() {
  return number_check("POSITIVE", "above 0", [](double value) { return value > 0.0; });
}
inline CLI::Validator not_negative() {
  return number_check("NONNEGATIVE", "of at least 0", [](double value) { return value >= 0.0; });
}

}  // namespace evbench
