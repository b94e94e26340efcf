#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/data/track.hpp"
#include "core/events/reader.hpp"
#include "core/geometry/camera.hpp"
#include "core/motion/pose_trajectory.hpp"

namespace evbench {

/// A sequence: a recording or a simulation. Sequence time starts at its own zero.
class Source {
 public:
  virtual ~Source() = default;

  virtual const Camera& camera() const = 0;

  /// The time of the sequence that a run uses, [s].
  struct TimeRange {
    double from = 0.0, to = 0.0;
  };
  virtual TimeRange time_range() const = 0;

  /// T_world_camera; empty when unknown.
  virtual const PoseTrajectory& ground_truth() const = 0;

  /// A new reader of the sequence's events, in sequence time [µs]; it may outlive the source. nullptr where there are
  /// none: a source of tracks.
  virtual std::unique_ptr<EventReader> events() const { return nullptr; }

  /// Track observations with known association (raw pixels, time order), for sources that know it: simulators.
  /// None where the source does not.
  virtual std::optional<std::span<const TrackObservation>> true_tracks() const { return std::nullopt; }

  /// Files that were read: they are hashed into the run's manifest.
  virtual std::vector<std::string> files() const { return {}; }

  /// What a user should know of the data: counts, oddities. For the run's log.
  virtual std::vector<std::string> remarks() const { return {}; }
};

}  // namespace evbench
