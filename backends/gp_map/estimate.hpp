#pragma once

#include <algorithm>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "backends/gp_map/counters.hpp"
#include "backends/gp_map/modules/noise_learning.hpp"
#include "backends/gp_map/smoother.hpp"

namespace evbench::gp_map {

/// The estimate of one map: the smoother, the noise learnt from the data, and the factors of its landmarks' sigmas.
/// It begins with an initial map.
class Estimate {
 public:
  /// `first`: the problem of an initial map; `enough`: landmarks in view that show fully that the camera moves;
  /// `tentative`: see is_tentative() [s].
  Estimate(FactorGraph first, const SmootherOptions& options, int enough, double tentative, Counters& counters)
      : smoother(std::move(first), options), enough_(enough), tentative_(tentative), counters_(counters) {
    factors_.resize(graph().landmarks.size());
  }

  Smoother smoother;
  UpdateSummary last_update;
  NoiseLearner noise;

  const FactorGraph& graph() const { return smoother.graph(); }
  const ControlState& newest() const { return graph().states.back(); }
  double now() const { return newest().t; }
  int enough() const { return enough_; }

  /// Pose and body velocity at any time that the states cover.
  std::optional<SE3> pose(double t) const;
  std::optional<Vector6> velocity(double t) const;

  /// Median depth of the landmarks seen last, from the newest pose; 1 if there are none.
  double median_depth() const;

  /// May the whole map still be replaced? Until it has seen so many seconds of motion: an event camera at rest sees
  /// nothing.
  bool is_tentative() const { return moved_ < tentative_; }

  /// After the newest state was estimated.
  void end_step();
  std::size_t steps() const { return steps_; }  ///< one a control state

  void update();

  int add_landmark(const Vector3& guess, const LandmarkPrior& prior);
  /// Before one of few landmarks of the scale anchor is removed, those in view are added to it, at the present scale.
  void remove_landmark(int landmark);

  /// Factors of a landmark's sigmas: of its track's own noise, and of the bound of its leverage. The larger one counts.
  double track_noise(int landmark) const { return factors_[index(landmark)].noise; }
  double leverage(int landmark) const { return factors_[index(landmark)].leverage; }
  void set_track_noise(int landmark, double factor);
  void set_leverage(int landmark, double factor);

  /// A landmark's covariance, kept from the first call until it is forgotten: it is expensive long after the landmark
  /// was in view, and changes little by then.
  std::optional<Matrix3> kept_covariance(int landmark);
  void forget_covariance(int landmark) { covariances_.erase(landmark); }
  void forget_covariances() { covariances_.clear(); }
  /// Of the newest state; computed once a step.
  const std::optional<Matrix12>& newest_covariance();

  void count(Count what, int by = 1) { counters_[what] += by; }

 private:
  struct Factors {
    double noise = 1.0, leverage = 1.0;
  };
  void scale_sigmas(int landmark);

  int enough_;
  double tentative_;
  Counters& counters_;
  std::vector<Factors> factors_;  ///< by landmark
  double moved_ = 0.0;            ///< [s] that it has seen motion for
  std::size_t steps_ = 1;
  std::map<int, std::optional<Matrix3>> covariances_;
  std::pair<std::size_t, std::optional<Matrix12>> newest_covariance_;  ///< in this step
};

}  // namespace evbench::gp_map
