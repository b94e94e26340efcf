#pragma once

#include "core/events/formats.hpp"

namespace evbench {

/// A config file as a recording: the events of its source, with the source's camera and ground truth. So what a
/// simulation would give can be described, converted and drawn like any recording.
EventFormat config_format();

}  // namespace evbench
