#pragma once

#include <evbench/plugin.hpp>
#include <optional>
#include <string>

#include "options.hpp"

namespace spline_map {

/// The initial map: a spline and landmarks, optimised over every observation of these landmarks.
struct InitialMap {
  Spline spline;
  Landmarks landmarks;
  Gauge gauge;
  double cost = 0.0;          ///< per observation
  double parallax_deg = 0.0;  ///< median over the landmarks, between the spline's start and the newest observations
};

/// Finds the initial map: refines two-view guesses (core/structure/initialiser) as splines over all observations, and
/// takes the one with the lowest cost once the data decide between them.
///
/// World frame: the camera at the spline's start. Unit of length: the median depth of the guess.
class InitialMapFinder {
 public:
  InitialMapFinder(const Options& options, const evbench::PinholeCamera& camera)
      : options_(options), camera_(camera), initialiser_(options.initialiser, camera) {}

  /// `tracks` contains the observations up to t, which increases from attempt to attempt.
  std::optional<InitialMap> attempt(const evbench::TrackBuffer& tracks, double t);

  /// Why the last attempt failed.
  const std::string& reason() const { return reason_; }

 private:
  std::optional<InitialMap> refine(const evbench::TrackBuffer& tracks, const evbench::InitialGuess& guess) const;
  double start_time(const evbench::TrackBuffer& tracks, const evbench::InitialGuess& guess) const;

  Options options_;
  evbench::PinholeCamera camera_;
  evbench::Initialiser initialiser_;
  std::string reason_ = "no observations";
};

}  // namespace spline_map
