#pragma once

#include <memory>
#include <string>

#include "core/plugin/source.hpp"

namespace evbench {

/// Writes all events of a source to a file of evbench's own format, for with_recorded_events(). False where this saves
/// nothing: the source has no events, or reads them from files. Throws OutputError for a full disk.
bool record_events(const Source& source, const std::string& path);

/// The source with its events read from such a recording, which has the same events. Where the file is missing or
/// damaged, the source itself: its events are then made again.
std::unique_ptr<Source> with_recorded_events(std::unique_ptr<Source> source, const std::string& path);

/// The source with its events kept in a file while they are first read to the end, and read from there from then on.
std::unique_ptr<Source> with_kept_events(std::unique_ptr<Source> source, const std::string& path);

}  // namespace evbench
