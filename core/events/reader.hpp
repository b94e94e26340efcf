#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/data/time_unit.hpp"
#include "core/events/event.hpp"
#include "core/events/faults.hpp"
#include "core/geometry/camera.hpp"
#include "core/motion/pose_trajectory.hpp"

namespace evbench {

/// How to read a recording.
struct ReadOptions {
  std::string topic = {};  ///< of a bag, group of an HDF5 file: whose events; empty: the only one, or the first
  /// Of a bag, likewise: whose poses and whose calibration; empty: those that go with the events.
  std::string ground_truth_topic = {}, camera_info_topic = {};
  bool strict = false;        ///< faults are errors, not counted skips
  bool lenient = false;       ///< however many they are (EventStream::large_loss)
  int width = 0, height = 0;  ///< sensor [px], where the file of events doesn't say; before what lies beside it
  /// Of text and of rows of HDF5, e.g. "t_us,x,y,p"; of HDF5's single columns only the unit counts. Empty: as the file
  /// looks.
  std::string columns = {};
};

/// Keys of the metadata, of what a run's log repeats: the topics of a bag that calibration and ground truth are from,
/// which one of several was taken, and what was found and not taken, and why.
inline constexpr const char *kCameraInfoIn = "camera info in", *kGroundTruthIn = "ground truth in",
                            *kTopicChoice = "choice of a topic",
                            *kUnusableCalibration = "calibration that cannot be used",
                            *kUnusableGroundTruth = "ground truth that cannot be used";

/// What a recording's headers say.
struct StreamInfo {
  std::string format;                                         ///< e.g. "Prophesee EVT 3"
  int width = 0, height = 0;                                  ///< sensor [px]; 0: unknown
  bool size_assumed = false;                                  ///< nothing says it; what the data set has
  std::optional<std::int64_t> count;                          ///< of events, where known without reading them
  std::optional<std::int64_t> start, end;                     ///< [µs] of the first and last event, likewise
  std::optional<TimeUnit> guessed_time_unit;                  ///< of the file's times, where nothing says it
  std::vector<std::string> topics;                            ///< everything in a container: "name (type), n messages"
  std::vector<std::pair<std::string, std::string>> metadata;  ///< further fields of the header
};

/// The events of a recording as its format has them; times are the file's own. EventStream (event_stream.hpp) puts
/// order, sensor limits, a time range and a zero on top of that.
class EventReader {
 public:
  virtual ~EventReader() = default;

  virtual const StreamInfo& info() const = 0;

  /// Replaces `events` by the next ones, some ten thousand at a time, in the file's order. False, and none, at the end.
  /// Memory does not depend on the length of the file.
  virtual bool read(std::vector<Event>& events) = 0;

  /// Reading goes on at or before the first event with time ≥ t [µs]: by the format's index where it has one, by
  /// reading from the beginning elsewhere.
  virtual void seek(std::int64_t t) = 0;

  /// Found when it was opened, and since the beginning or the last seek.
  virtual const Faults& faults() const = 0;

  /// Where the recording has them; poses are T_world_camera, or of another body where the metadata says so, times in
  /// [s].
  virtual std::optional<PoseTrajectory> ground_truth() { return std::nullopt; }
  virtual std::optional<Camera> calibration() { return std::nullopt; }
  /// Paths of the files beside the events that these two have read.
  virtual std::vector<std::string> files_beside() const { return {}; }
};

}  // namespace evbench
