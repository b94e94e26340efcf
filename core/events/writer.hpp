#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/events/event.hpp"
#include "core/geometry/camera.hpp"
#include "core/io/part_file.hpp"
#include "core/motion/pose_trajectory.hpp"

namespace evbench {

/// A recording's content other than events; formats keep what they have a place for.
struct RecordingHeader {
  int width = 0, height = 0;  ///< sensor [px]; 0: unknown
  std::vector<std::pair<std::string, std::string>> metadata;
  std::optional<Camera> calibration;
  PoseTrajectory ground_truth;  ///< empty: unknown
};

/// Writes a recording; events come in time order and within the sensor. All functions throw InputError for what the
/// format can't hold, and OutputError for a full disk.
class EventWriter {
 public:
  virtual ~EventWriter() = default;
  virtual void write(std::span<const Event> events) = 0;
  /// Completes the file; to be called once, at the end.
  virtual void finish() = 0;
};

/// A format that can be written.
struct WritableFormat {
  std::string name;         ///< e.g. "native"
  std::string extension;    ///< that selects it, e.g. ".evb"
  std::string description;  ///< a line
  PartFile::Needs needs;    ///< requirements on the file that it writes to
  /// `path`: to write to; `name`: the file's, for messages.
  std::unique_ptr<EventWriter> (*make)(const std::string& path, const std::string& name, const RecordingHeader& header);
};

const std::vector<WritableFormat>& writable_formats();

}  // namespace evbench
