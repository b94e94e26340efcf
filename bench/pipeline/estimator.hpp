#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <set>
#include <vector>

#include "bench/pipeline/covariance_samples.hpp"
#include "bench/pipeline/trajectory_segment.hpp"
#include "core/plugin/backend.hpp"

namespace evbench {

/// One of a run's back-ends, what it published, and in whose world it stands: in its own, until landmarks that both have
/// show where that lies in the world of one before it.
struct Estimator {
  explicit Estimator(std::size_t its_number) : number(its_number), world(its_number) {}

  std::size_t number;  ///< from 0, in the order in which they are made
  std::unique_ptr<BackEnd> backend;
  std::vector<CausalPose> published;       ///< in its own world
  double last_known_at = 0.0;                  ///< [s], when the last of these was known, in the back-end's words
  std::optional<StampedPose> newest;  ///< of these
  CovarianceSamples covariances;

  std::optional<Status> ended;  ///< how it was taken out of the run, where it did not tell that itself
  std::set<TrackId> doubtful;   ///< tracks that may have been on something else since then

  std::size_t world;                     ///< number of the estimator whose world it is
  Similarity to_world;                   ///< carries its own world to that one
  std::vector<CausalPose> published_in_world{};  ///< what it told since it was found there, in that world

  void stand_alone() {
    world = number;
    to_world = {};
  }

  Status status() const { return ended ? *ended : backend->status(); }

  bool is_elsewhere() const { return world != number; }

  /// Takes a pose that was told while data up to `seen` were looked at, of which a batch up to `until` was made [s].
  /// Throws std::runtime_error for one that is not finite or known before what was told already.
  void on_pose(CausalPose pose, double until, double seen);

  /// But for landmarks of doubtful tracks.
  std::vector<Landmark> trusted_map() const;

  /// Where it stands in another one's world, and by how many landmarks.
  struct Found {
    std::size_t world;
    Similarity to_world;
    int landmarks;
  };
  /// Looks for its world in that of another one, by landmarks that both have.
  std::optional<Found> find_in(const Estimator& other, const PinholeCamera& camera) const;
  void stand_in(const Found& found);

  /// Its estimate in its own world, once it is finished; none where it has none. `rate`: of the final trajectory [Hz];
  /// 0: the back-end's own poses. Throws std::runtime_error for a trajectory that is not finite.
  std::optional<TrajectorySegment> segment(double rate);
};

}  // namespace evbench
