#pragma once

#include <memory>

#include "core/events/formats.hpp"
#include "core/events/reader.hpp"
#include "core/io/byte_source.hpp"

namespace evbench {

/// Prophesee DAT, version 1 or 2: a header of "% key value" lines, the type and size of events (a byte each), events.
/// Throws InputError for a header that is broken, and for events that are no brightness changes of 8 bytes.
std::unique_ptr<EventReader> open_dat(std::unique_ptr<ByteSource> source, const ReadOptions& options);

EventFormat dat_format();

}  // namespace evbench
