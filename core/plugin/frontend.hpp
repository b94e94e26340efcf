#pragma once

#include <string>
#include <vector>

#include "core/data/track.hpp"
#include "core/plugin/backend.hpp"
#include "core/plugin/source.hpp"

namespace evbench {

/// A front-end: makes track observations from a source. One run owns one front-end; several back-ends of a comparison
/// get the identical observations only from front-ends that ignore feedback.
class FrontEnd {
 public:
  virtual ~FrontEnd() = default;

  /// Appends the next observations with time ≤ until [s], in time order, raw pixels. False when none are left
  /// at any time.
  virtual bool advance(double until, std::vector<TrackObservation>& observations) = 0;

  /// What the back-end knows: predicted motion, outlier tracks. May be ignored.
  virtual void receive(const Feedback& /*feedback*/) {}

  /// Files that were read beside the source's: they are hashed into the run's manifest.
  virtual std::vector<std::string> files() const { return {}; }

  /// What a user should know of the tracks: counts, oddities, what was left out. For the run's log.
  virtual std::vector<std::string> remarks() const { return {}; }
};

}  // namespace evbench
