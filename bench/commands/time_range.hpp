#pragma once

#include <CLI/CLI.hpp>
#include <optional>

#include "core/events/event_stream.hpp"

namespace evbench {

/// --from and --to as they are given [s].
struct TimeRangeArguments {
  std::optional<double> from, to;
};

/// --from, --to, --rebase of commands that read events.
void add_time_range(CLI::App& command, TimeRangeArguments& range, StreamOptions& options);

/// Throws InputError when the range is empty or no time at all.
void set_time_range(const TimeRangeArguments& range, StreamOptions& options);

}  // namespace evbench
