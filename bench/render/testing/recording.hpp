#pragma once

#include <span>
#include <string>

#include "core/events/native/native.hpp"
#include "core/testing/data.hpp"

namespace evbench::testing {

/// Of a sensor of 20x10 pixels.
inline RecordingHeader small_sensor() {
  RecordingHeader header;
  header.width = 20;
  header.height = 10;
  return header;
}

/// A recording in evbench's own format; its path.
inline std::string write_native(const TemporaryFolder& folder, const std::string& name, std::span<const Event> events,
                                const RecordingHeader& header = small_sensor()) {
  NativeWriter writer(folder.file(name), header);
  writer.write(events);
  writer.finish();
  return folder.file(name);
}

}  // namespace evbench::testing
