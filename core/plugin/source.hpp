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

namespace evbench {

/// What makes a source, besides its options.
struct SourceContext {
  std::uint64_t seed = 0;
  std::string folder;            ///< what relative paths in options refer to
  std::string place = "source";  ///< where the options stand, for messages: "config.json: source"
};

/// A sequence: a recording or a simulation. Everything of it is in sequence time, whose zero is the source's own; a run
/// uses time_range() of it.
class Source {
 public:
  virtual ~Source() = default;

  virtual const Camera& camera() const = 0;

  /// The time of the sequence that a run uses, [s]: its clock goes from the one to the other, whatever is seen.
  virtual TimeRange time_range() const = 0;

  /// T_world_camera; empty when unknown.
  virtual const PoseTrajectory& ground_truth() const = 0;

  /// The events that a front-end gets: in time order, within the camera's sensor, from ≤ t ≤ to of the time range, from
  /// its beginning. nullptr where there are none: a source of tracks. The source must outlive it. Throws InputError
  /// where camera and events say different sizes of the sensor, or the camera none.
  std::unique_ptr<EventStream> events() const;

  /// The sequence's events as they come, in sequence time [µs], from its own beginning to its end; events() is made of
  /// it. nullptr where there are none.
  virtual std::unique_ptr<EventReader> all_events() const { return nullptr; }

  /// Whether there are no events after the last one, up to the sequence's end, because nothing was to be seen, as in a
  /// simulation. A recording may just have been cut off.
  virtual bool silence_is_known() const { return false; }

  /// A sentence, where nothing says how large the camera's sensor is and its size is assumed. An event outside it is
  /// then an error of events().
  virtual std::string size_assumption() const { return {}; }

  /// Whether events() may leave out however many have to be (EventStream::large_loss).
  virtual bool is_lenient() const { return false; }

  /// Track observations with known association (raw pixels, time order), for sources that know it: simulators.
  /// None where the source does not.
  virtual std::optional<std::span<const TrackObservation>> true_tracks() const { return std::nullopt; }

  /// Files that the sequence is made of, but for its events: their content is part of a run's identity.
  virtual std::vector<std::string> files() const { return {}; }
  /// The files of the events: likewise, where the front-end reads them.
  virtual std::vector<std::string> event_files() const { return {}; }

  /// What a user should know of the data: counts, oddities. For the run's log.
  virtual std::vector<std::string> remarks() const { return {}; }
};

}  // namespace evbench
