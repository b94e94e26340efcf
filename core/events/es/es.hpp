#pragma once

#include <memory>

#include "core/events/formats.hpp"
#include "core/events/reader.hpp"
#include "core/io/byte_source.hpp"

namespace evbench {

/// Event Stream version 2 with DVS or ATIS events. Throws InputError for other versions and kinds, and for a sensor
/// without pixels.
std::unique_ptr<EventReader> open_es(std::unique_ptr<ByteSource> source, const ReadOptions& options);

EventFormat es_format();

}  // namespace evbench
