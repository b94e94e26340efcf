#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/events/event_stream.hpp"

namespace evbench {

struct ConversionOptions {
  StreamOptions stream;
  std::string format;     ///< a writable format's name; empty: by the extension
  bool force = true;      ///< replaces an older file, but never the input
  std::string undistort;  ///< calib.txt of the lens to be removed, or "own": the recording's; empty: none
  std::string camera;     ///< of a calibration of several; empty: the only one
};

struct ConversionReport {
  std::string format;
  std::int64_t written = 0;
  std::vector<std::string> unusable;                          ///< left out calibration or ground truth, and why
  std::int64_t outside = 0;                                   ///< undistorted pixels beyond the sensor, left out
  std::vector<std::pair<std::string, Faults::Fault>> faults;  ///< of the recording, left out
};

/// Writes a recording in another format. Nothing is left at `out` when that fails or is interrupted, and an older file
/// stays. `progress` is called with the number of events read, and the time reached [µs].
/// Throws InputError when `out` names no writable format, exists without `force` or is the input, for a sensor of
/// unknown size or another than the calibration's where undistortion needs it, when no event is left to be written, and
/// for any error of reader and writer.
ConversionReport convert(const std::string& in, const std::string& out, const ConversionOptions& options,
                         const std::function<void(std::int64_t, std::int64_t)>& progress = {});

}  // namespace evbench
