#include "core/events/time_guess.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

#include "core/support/error.hpp"
#include "core/support/index.hpp"

namespace evbench {
namespace {

constexpr TimeUnit kUnits[] = {TimeUnit::seconds, TimeUnit::milliseconds, TimeUnit::microseconds,
                               TimeUnit::nanoseconds};

double year(double time, TimeUnit unit) {
  constexpr double kSecondsOfYear = 365.2425 * 86400.0;
  return std::floor(1970.0 + time / per_second(unit) / kSecondsOfYear);
}

std::string columns_of(TimeUnit unit) { return fmt::format("t_{},x,y,p", kTimeUnitNames[index(unit)]); }

}  // namespace

TimeUnit guess_time_unit(double time, bool have_fractions, const std::string& place) {
  constexpr double kLatestYear = 5000.0, kLatestPlausibleYear = 2200.0;
  const TimeUnit guess = have_fractions ? TimeUnit::seconds : TimeUnit::microseconds;
  if (!(year(time, guess) >= kLatestYear)) return guess;
  const auto may_be = [&](TimeUnit unit) { return year(time, unit) < kLatestPlausibleYear; };
  const auto* const unit = std::ranges::find_if(kUnits, may_be);
  std::string hint;
  if (unit != std::end(kUnits)) {
    hint = fmt::format(" with t_{0}, if it is that: {1} makes it the year {2:.0f}, not {3:.0f}",
                       kTimeUnitNames[index(*unit)], columns_of(*unit), year(time, *unit), year(time, guess));
  }
  throw InputError(
      fmt::format("{}: has the time {}, too late for {}; give --columns (source.columns in a run's config){}", place,
                  time, to_string(guess), hint));
}

std::optional<std::string> implausible_rate(std::int64_t count, double duration, TimeUnit unit) {
  constexpr double kFewest = 1e3, kUsual = 3e5, kMost = 1e9;  // events a second
  constexpr std::int64_t kEnough = 200;
  const double rate = 1e6 * static_cast<double>(count) / duration;
  if (count < kEnough || duration < 0.0 || (rate >= kFewest && rate <= kMost)) return std::nullopt;
  if (!(duration > 0.0)) return fmt::format("all {} events have the same time: are its digits lost?", count);
  const auto rate_in = [&](TimeUnit other) { return rate * per_second(other) / per_second(unit); };
  // The unit with the most plausible rate. Times with fractions were taken for seconds; nanoseconds have none.
  const auto improbability = [&](TimeUnit other) {
    if (unit == TimeUnit::seconds && other == TimeUnit::nanoseconds) return std::numeric_limits<double>::infinity();
    return std::abs(std::log10(rate_in(other) / kUsual));
  };
  const TimeUnit best = *std::ranges::min_element(kUnits, {}, improbability);
  std::string text =
      fmt::format("{:.4g} events/s on average, {} than event cameras give", rate, rate < kFewest ? "fewer" : "more");
  if (best != unit) {
    text += fmt::format(": are the times {}? In {} (--columns {}) it would be {:.4g}/s", to_string(unit),
                        to_string(best), columns_of(best), rate_in(best));
  }
  return text;
}

}  // namespace evbench
