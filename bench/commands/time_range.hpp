#pragma once

#include <CLI/CLI.hpp>
#include <optional>

#include "core/events/event_stream.hpp"

namespace evbench {

/// Values of --from and --to [s].
struct TimeRangeArguments {
  std::optional<double> from, to;
};

/// Adds --from, --to and --rebase to a command that reads events.
void add_time_range(CLI::App& command, TimeRangeArguments& range, StreamOptions& options);

/// Throws InputError if the range is empty or not finite.
void set_time_range(const TimeRangeArguments& range, StreamOptions& options);

}  // namespace evbench
