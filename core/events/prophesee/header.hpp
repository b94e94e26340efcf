#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/events/reader.hpp"
#include "core/io/byte_source.hpp"

namespace evbench {

/// The header of Prophesee's RAW and DAT files: lines of "% key value" before the data.
struct PropheseeHeader {
  std::vector<std::pair<std::string, std::string>> fields;  ///< as in the file; "format" is split at its semicolons
  std::uint64_t size = 0;                                   ///< [bytes]

  /// Value of the first field of this name, in upper or lower case; empty: none.
  std::string value(const std::string& name) const;
};

/// Throws InputError when the header doesn't end within 64 KiB.
PropheseeHeader read_prophesee_header(ByteSource& source);
PropheseeHeader parse_prophesee_header(std::span<const std::byte> head, const std::string& name);

/// Sensor size and metadata. If the header states no size, it is the one in the options, else that of the camera that
/// the header names, else unknown. Throws InputError for a size that no sensor has.
StreamInfo prophesee_info(const PropheseeHeader& header, std::string format, const ReadOptions& options,
                          const std::string& name);

/// Parses a sensor's width or height: 1 to 65,535 pixels. Throws InputError.
int parse_sensor_side(const std::string& text, const std::string& what);

}  // namespace evbench
