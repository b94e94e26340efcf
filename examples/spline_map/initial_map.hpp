#pragma once

#include <optional>
#include <string>

#include "core/structure/track_buffer.hpp"
#include "options.hpp"

namespace spline_map {

/// What the back-end starts from: a spline and landmarks, solved over every observation of these landmarks.
struct InitialMap {
  Spline spline;
  Landmarks landmarks;
  Gauge gauge;
  double cost = 0.0;          ///< per observation
  double parallax_deg = 0.0;  ///< median over the landmarks, between the spline's start and the newest observations
};

/// Finds the initial map: guesses from two views (core/structure/initialiser), each refined as a spline over all
/// observations, the cheapest of them when the data decide between them.
///
/// World frame: the camera at the spline's start. Unit of length: the median depth that the guess has.
class InitialMapFinder {
 public:
  InitialMapFinder(const Options& options, const evbench::PinholeCamera& camera)
      : options_(options), camera_(camera), initialiser_(options.initialiser, camera) {}

  /// `tracks` hold the observations up to t, later than at the attempts before.
  std::optional<InitialMap> attempt(const evbench::TrackBuffer& tracks, double t);

  /// Why the last attempt was vain.
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
