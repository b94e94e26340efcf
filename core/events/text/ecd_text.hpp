#pragma once

#include <memory>
#include <string>

#include "core/events/formats.hpp"
#include "core/events/reader.hpp"
#include "core/io/byte_source.hpp"

namespace evbench {

/// Events as text, a line each, as text_layout.hpp describes: the Event-Camera Dataset's "t x y p" and other orders and
/// units. info().metadata says what was found.
std::unique_ptr<EventReader> open_text(std::unique_ptr<ByteSource> source, const ReadOptions& options);

/// A text file, a folder with events.txt, or a .zip with events.txt in any folder. Files next to it belong to it:
/// calib.txt (calibration), groundtruth.txt, and images/, whose size is the sensor's if the text doesn't state it.
std::unique_ptr<EventReader> open_ecd_text(const std::string& path, const ReadOptions& options);

EventFormat ecd_text_format();

}  // namespace evbench
