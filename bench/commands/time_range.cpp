#include "bench/commands/time_range.hpp"

#include <fmt/format.h>

#include <cmath>

#include "bench/commands/number_check.hpp"
#include "core/support/error.hpp"

namespace evbench {
namespace {

std::optional<std::int64_t> microseconds(const std::optional<double>& seconds, const char* option) {
  if (!seconds) return std::nullopt;
  if (!(std::abs(*seconds) < 1e12)) throw InputError(fmt::format("{}: is {}; expected seconds", option, *seconds));
  return std::llround(*seconds * 1e6);
}

}  // namespace

void add_time_range(CLI::App& command, TimeRangeArguments& range, StreamOptions& options) {
  command.add_option("--from", range.from, "Only events from this time on [s], after --rebase")->check(finite_number());
  command.add_option("--to", range.to, "Only events before this time [s], after --rebase")->check(finite_number());
  command.add_flag("--rebase", options.rebase, "The first event's time becomes zero");
}

void set_time_range(const TimeRangeArguments& range, StreamOptions& options) {
  options.from = microseconds(range.from, "--from");
  options.to = microseconds(range.to, "--to");
  if (options.from && options.to && *options.from >= *options.to) {
    throw InputError(fmt::format("--from {} --to {}: expected from < to", *range.from, *range.to));
  }
}

}  // namespace evbench
