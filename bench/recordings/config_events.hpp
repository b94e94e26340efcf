#pragma once

#include <functional>
#include <memory>
#include <string>

#include "core/events/reader.hpp"
#include "core/plugin/registry.hpp"

namespace evbench {

/// Opens a recording, or a config file as one: the events of its source, with the source's camera and ground truth. So
/// a simulation can be described, converted and drawn like any recording. A source itself reads only recordings, so a
/// config cannot refer to itself. `plugins` must outlive the function, which throws InputError as open_events() and
/// read_source() do, and for a source without events.
std::function<std::unique_ptr<EventReader>(const std::string& path, const ReadOptions& options)> recordings_and_configs(
    const Plugins& plugins);

}  // namespace evbench
