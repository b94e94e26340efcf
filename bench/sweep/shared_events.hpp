#pragma once

#include <memory>
#include <string>

#include "core/plugin/source.hpp"

namespace evbench {

/// Writes all events of a source to a file of evbench's own format, from which with_recorded_events() takes them once
/// more. False where there is nothing to be saved by it: the source has none, or reads them from files. Throws
/// OutputError for a full disk.
bool record_events(const Source& source, const std::string& path);

/// The source with its events read from such a recording of them, the same ones; the source itself where there is no
/// such file or it is damaged: its events are then made again.
std::unique_ptr<Source> with_recorded_events(std::unique_ptr<Source> source, const std::string& path);

}  // namespace evbench
