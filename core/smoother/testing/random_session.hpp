#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/simulation/random.hpp"
#include "core/smoother/smoother.hpp"

namespace evbench::smoother::testing {

/// Options under which the problem is linear: then every order of operations ends at one estimate.
SmootherOptions linear_options();

struct SessionOptions {
  SmootherOptions engine;
  MotionPrior motion_prior = {};
  bool anchor = true;       ///< the scale anchor is set and loses landmarks
  bool full_twin = false;   ///< a second engine with full history gets everything that the first one accepted
  bool covariances = true;  ///< are queried in between
};

/// A small world and an engine that gets random operations, sensible or not. After every operation it checks what must
/// always hold: estimates and covariances are finite, covariances are positive definite, and impossible requests are
/// refused.
class RandomSession {
 public:
  RandomSession(std::uint64_t seed, const SessionOptions& options);

  /// A number of operations: small mostly, large for 1 in 50.
  int draw_length();
  void operate();
  void update();
  void check_covariances();
  /// Adds a landmark that the newest state observes and whose guess, and so its linearisation point, is this deep [m]
  /// in front of it. Returns its index.
  int add_close_landmark(double depth);

  Random& random() { return random_; }
  Smoother& engine() { return engine_; }
  const Smoother& twin() const { return *twin_; }
  bool undetermined() const { return undetermined_; }  ///< a variable was regularised in some update
  /// The problem that a linear session has solved (the twin's if there is one), with all variables at their guesses.
  FactorGraph linear_problem() const;

  /// An observation of a random landmark at a random time in the newest interval; none if the landmark is not in view
  /// or there is no interval.
  struct Seen {
    int landmark = 0;
    Observation observation;
  };
  std::optional<Seen> draw_observation();

 private:
  const FactorGraph& graph() const { return engine_.graph(); }
  double newest() const { return graph().states.back().t; }
  bool chance(double p) { return random_.uniform() < p; }
  int any_landmark() { return static_cast<int>(random_.index(truth_.size())); }
  double time_in(double from, double to) { return chance(0.1) ? to : random_.uniform(from, to); }

  void add_state();
  void add_landmark();
  int insert_landmark(const Vector3& truth, const Vector3& guess, const LandmarkPrior& prior);
  std::optional<Observation> measure(int landmark, double t);
  void observe(int landmark, double from, double to);
  bool give(int landmark, const Observation& observation);
  void late_observation();
  void remove_landmark(int landmark);
  void remove_observations();
  void scale_sigmas();
  void place();
  void remove_newest_state();
  void refused();
  void degenerate_landmark();
  void anchor_scale();

  Random random_;
  SessionOptions options_;
  Smoother engine_;
  std::optional<Smoother> twin_;
  std::vector<Vector3> truth_;  ///< of the landmarks
  std::vector<ControlState> state_guesses_;
  std::vector<Vector3> landmark_guesses_;
  bool undetermined_ = false;
};

}  // namespace evbench::smoother::testing
