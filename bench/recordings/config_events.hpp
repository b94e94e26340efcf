#pragma once

#include "core/events/formats.hpp"
#include "core/plugin/registry.hpp"

namespace evbench {

/// A config file as a recording: the events of its source, with the source's camera and ground truth. So what a
/// simulation would give can be described, converted and drawn like any recording. `plugins` must outlive
/// the format.
EventFormat config_format(const Plugins& plugins);

}  // namespace evbench
