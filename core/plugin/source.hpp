#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/data/time_range.hpp"
#include "core/data/track.hpp"
#include "core/events/event_stream.hpp"
#include "core/geometry/camera.hpp"
#include "core/motion/pose_trajectory.hpp"
#include "core/plugin/point_truth.hpp"

namespace evbench {

/// What a source gets in addition to its options.
struct SourceContext {
  std::uint64_t seed = 0;
  std::string folder;            ///< base of relative paths in options
  std::string place = "source";  ///< place of the options, for messages: "config.json: source"
};

/// What a front-end sees of a sequence: everything but the ground truth. All times are sequence time, whose zero the
/// source defines; a run uses time_range() of it.
class SensorData {
 public:
  virtual ~SensorData() = default;

  virtual const Camera& camera() const = 0;

  /// The time range that a run uses [s]: its clock runs from the beginning to the end, whether or not there are events.
  virtual TimeRange time_range() const = 0;

  /// A new stream of the events for a front-end: in time order, within the camera's sensor, from ≤ t ≤ to of the time
  /// range. nullptr for a source of tracks without events. The source must outlive the stream. Throws InputError when
  /// the sensor sizes of camera and events differ, or the camera has none.
  std::unique_ptr<EventStream> events() const;

  /// All events of the sequence as recorded, in sequence time [µs]; events() filters them. nullptr if there are none.
  virtual std::unique_ptr<EventReader> all_events() const { return nullptr; }

  /// True if no event between the last one and the sequence's end means that nothing moved, as in a simulation. False
  /// for a recording, which may have been cut off.
  virtual bool silence_is_known() const { return false; }

  /// A sentence if the sensor size is not given and was assumed; else empty. An event outside the assumed sensor is
  /// then an error of events().
  virtual std::string size_assumption() const { return {}; }

  /// May events() drop any number of invalid events (EventStream::large_loss)?
  virtual bool is_lenient() const { return false; }

  /// Track observations with true association (raw pixels, time order), for simulators. None if it is unknown.
  virtual std::optional<std::span<const TrackObservation>> true_tracks() const { return std::nullopt; }
};

/// A sequence: a recording or a simulation.
class Source : public SensorData {
 public:
  /// T_world_camera; empty when unknown.
  virtual const PoseTrajectory& ground_truth() const = 0;

  /// Ground truth of tracks of any point, for simulators of events: front-ends' tracks are scored with it. nullptr if
  /// it is unknown.
  virtual std::shared_ptr<const PointTruth> point_truth() const { return nullptr; }

  /// Files of the sequence without those of the events: their content is part of a run's identity.
  virtual std::vector<std::string> files() const { return {}; }
  /// Files of the events: part of a run's identity if the front-end reads events.
  virtual std::vector<std::string> event_files() const { return {}; }

  /// Remarks on the data for the run's log: counts, anomalies.
  virtual std::vector<std::string> remarks() const { return {}; }
};

}  // namespace evbench
