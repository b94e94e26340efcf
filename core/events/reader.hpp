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
  std::string topic = {};  ///< topic of a bag or group of an HDF5 file; empty: the only one, or the first
  /// Topics of a bag with ground truth and calibration; empty: those that belong to the events.
  std::string ground_truth_topic = {}, camera_info_topic = {};
  bool strict = false;        ///< faults are errors, not counted skips
  bool lenient = false;       ///< any number of them is accepted (EventStream::large_loss)
  int width = 0, height = 0;  ///< sensor [px], if the events' file doesn't state it; precedes companion files
  /// Columns of text and of rows of HDF5, e.g. "t_us,x,y,p"; of HDF5's separate columns only the unit counts. Empty:
  /// found from the file.
  std::string columns = {};
};

/// Keys of the metadata that a run's log repeats: the bag topics of calibration and ground truth, which of several
/// topics was taken, and what was found but not used, and why.
inline constexpr const char *kCameraInfoIn = "camera info in", *kGroundTruthIn = "ground truth in",
                            *kTopicChoice = "choice of a topic",
                            *kUnusableCalibration = "calibration that cannot be used",
                            *kUnusableGroundTruth = "ground truth that cannot be used";

/// What a recording's headers state.
struct StreamInfo {
  std::string format;                                         ///< e.g. "Prophesee EVT 3"
  int width = 0, height = 0;                                  ///< sensor [px]; 0: unknown
  bool size_assumed = false;                                  ///< not stated, but known of the data set
  std::optional<std::int64_t> count;                          ///< of events, where known without reading them
  std::optional<std::int64_t> start, end;                     ///< [µs] of the first and last event, likewise
  std::optional<TimeUnit> guessed_time_unit;                  ///< of the file's times, if nothing states it
  std::vector<std::string> topics;                            ///< everything in a container: "name (type), n messages"
  std::vector<std::pair<std::string, std::string>> metadata;  ///< further fields of the header
};

/// The events of a recording as its format has them; times are the file's own. EventStream (event_stream.hpp) adds
/// order, sensor limits, a time range and a zero.
class EventReader {
 public:
  virtual ~EventReader() = default;

  virtual const StreamInfo& info() const = 0;

  /// Replaces `events` by the next ones, some ten thousand at a time, in the file's order. At the end there are none
  /// and it returns false. Memory does not depend on the length of the file.
  virtual bool read(std::vector<Event>& events) = 0;

  /// Continues at or before the first event with time ≥ t [µs]: by the format's index if it has one, otherwise by
  /// reading from the beginning.
  virtual void seek(std::int64_t t) = 0;

  /// Faults found on opening, and since the beginning or the last seek.
  virtual const Faults& faults() const = 0;

  /// If the recording has them. Poses are T_world_camera, or those of another body if the metadata says so; times in
  /// [s].
  virtual std::optional<PoseTrajectory> ground_truth() { return std::nullopt; }
  virtual std::optional<Camera> calibration() { return std::nullopt; }
  /// Paths of the companion files that these two have read.
  virtual std::vector<std::string> companion_files() const { return {}; }
};

}  // namespace evbench
