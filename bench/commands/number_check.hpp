#pragma once

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <charconv>
#include <cmath>
#include <functional>
#include <string>

namespace evbench {

/// Checks the number of an option. Every option of a floating-point type has such a check, so that no value is NaN or
/// infinite: the checks of CLI11 accept NaN. `name`: in help texts.
inline CLI::Validator number_check(const std::string& name, const std::string& expected,
                                   std::function<bool(double)> good) {
  const auto check = [expected, good = std::move(good)](const std::string& text) {
    double value = 0.0;
    const char* const begin = text.data() + (text.starts_with('+') ? 1 : 0);
    const char* const end = text.data() + text.size();
    const auto [read, error] = std::from_chars(begin, end, value);
    if (error == std::errc() && read == end && std::isfinite(value) && good(value)) return std::string();
    return fmt::format("{}: expected a finite number{}", text, expected);
  };
  return {check, name};
}

inline CLI::Validator finite_number() {
  return number_check("", "", [](double) { return true; });
}
inline CLI::Validator above_zero() {
  return number_check("POSITIVE", " above 0", [](double value) { return value > 0.0; });
}
inline CLI::Validator not_negative() {
  return number_check("NONNEGATIVE", " of at least 0", [](double value) { return value >= 0.0; });
}
/// Includes both ends.
inline CLI::Validator in_range(double from, double to) {
  return number_check(fmt::format("{} to {}", from, to), fmt::format(" from {} to {}", from, to),
                      [=](double value) { return value >= from && value <= to; });
}

}  // namespace evbench
