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

/// One of a run's back-ends, its published poses, and the world frame in which they are reported. That is its own
/// world, until it is relocalised in the world of an earlier one by common landmarks.
struct Estimator {
  explicit Estimator(std::size_t its_number) : number(its_number), world(its_number) {}

  std::size_t number;  ///< from 0, in order of creation
  std::unique_ptr<BackEnd> backend;
  std::vector<CausalPose> published;  ///< in its own world
  double last_known_at = 0.0;         ///< [s], of the last of these, as the back-end stated it
  std::optional<StampedPose> newest;  ///< of these
  CovarianceSamples covariances;

  std::optional<Status> ended;    ///< set if the harness ended the back-end: overrides its own status
  std::set<TrackId> unconfirmed;  ///< tracks that may observe other scene points since it ended

  std::size_t world;                             ///< number of the estimator whose world is used
  Similarity to_world;                           ///< from its own world to that one
  std::vector<CausalPose> published_in_world{};  ///< poses published since the relocalisation, in that world

  void use_own_world() {
    world = number;
    to_world = {};
  }

  Status status() const { return ended ? *ended : backend->status(); }

  bool is_relocalised() const { return world != number; }

  /// Takes a published pose. `until` and `seen` [s] are those of the current batch (TrackBatch). Throws
  /// std::runtime_error for a pose that is not finite or whose known_at decreases.
  void on_pose(CausalPose pose, double until, double seen);

  /// The map without landmarks of unconfirmed tracks.
  std::vector<Landmark> confirmed_map() const;

  /// Transform to the world of an earlier estimator, and the number of landmarks that support it.
  struct Relocalisation {
    std::size_t world;
    Similarity to_world;
    int landmarks;
  };
  /// Aligns its map with that of another one by common landmarks. None if too few agree.
  std::optional<Relocalisation> find_in(const Estimator& other, const PinholeCamera& camera) const;
  void relocalise(const Relocalisation& found);

  /// The finished estimate in its own world; none if there is no trajectory. `rate`: of the final trajectory [Hz];
  /// 0: the back-end's own poses. Throws std::runtime_error for a trajectory that is not finite.
  std::optional<TrajectorySegment> segment(double rate);
};

}  // namespace evbench
