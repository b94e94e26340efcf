#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "core/events/writer.hpp"

namespace evbench::native {

/// The metadata at the end of a native file: JSON with the recording's fields, calibration and ground truth.
std::string format_metadata(const RecordingHeader& recording);

/// `width`, `height`: the sensor's [px]; `name`: the file's, for messages. Throws InputError for text that is no such
/// JSON.
RecordingHeader parse_metadata(std::span<const std::byte> text, int width, int height, const std::string& name);

}  // namespace evbench::native
