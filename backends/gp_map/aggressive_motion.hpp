#pragma once

#include <functional>

#include "backends/gp_map/engine/engine.hpp"
#include "backends/gp_map/noise_learning.hpp"

namespace evbench::gp_map {

/// How many times as weak the prior should be, by factors of ten up to `most`, to bring most tracks near that are
/// `error` off [sigmas]; `error_at(f)` is what they are off when it is f times as weak. As far as that was worth it: a
/// motion that the prior held back comes near, a few tracks that err together by chance come a little nearer each time.
double worth_weakening(double error, double most, const std::function<double(double)>& error_at);

/// Keeps hold of a camera that moves more violently than the prior expects: brings the newest state to where its
/// observations ask for it, by more Gauss-Newton steps where one has not arrived, and by a weaker prior where that one
/// holds it back. The robust loss would else take good tracks for outliers.
class AggressiveMotion {
 public:
  /// `min_landmarks`: in view, with fewer nothing is concluded; `window`: in which a prior that has yielded is as it
  /// was again [s]; `qc`: the prior's density where nothing has yielded.
  AggressiveMotion(int min_landmarks, double window, const Vector6& qc)
      : min_landmarks_(min_landmarks), window_(window), qc_(qc) {}

  /// Once an update of the engine is done and may have left most tracks far from where they should be: what is needed
  /// beyond it. Returns the last update's summary. `noise`: of the tracks.
  UpdateSummary follow(Engine& engine, const NoiseLearner& noise, const UpdateSummary& update) const;

  /// Whether the prior yields now: the tracks' errors tell of the motion then.
  bool is_yielding(const FactorGraph& graph) const;

  /// The density of the intervals to come goes back to what it was, as far as time has passed.
  void recover(Engine& engine) const;

 private:
  double newest_error(const FactorGraph& graph, const NoiseLearner& noise) const;

  int min_landmarks_;
  double window_;
  Vector6 qc_;
};

}  // namespace evbench::gp_map
