#pragma once

#include <evbench/plugin.hpp>
#include <map>
#include <span>
#include <vector>

#include "spline.hpp"

namespace spline_map {

/// A track that is a landmark of the map. Observations are in time order, none before the spline's start.
struct MappedTrack {
  Vector3 position = Vector3::Zero();  ///< world frame
  std::vector<evbench::UndistortedObservation> observations;
};

/// Landmarks by track, in the order of the ids, so that iteration is deterministic.
using Landmarks = std::map<evbench::TrackId, MappedTrack>;

/// Mean norm of a landmark's reprojection error over all its observations [px].
double mean_error(const MappedTrack& landmark, const Spline& spline, const evbench::PinholeCamera& camera);

/// Triangulates a track from the spline. Observations before its start are ignored, many observations are subsampled.
evbench::Triangulation triangulate_track(std::span<const evbench::UndistortedObservation> observations,
                                         const Spline& spline, const evbench::PinholeCamera& camera,
                                         const evbench::TriangulationOptions& options);

}  // namespace spline_map
