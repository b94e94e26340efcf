#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "frontends/str/registration/alignment.hpp"

namespace evbench::str {

struct RegistrationOptions {
  MotionModel model = MotionModel::rotation;
  double slice = 0.25;
  int queries = 5000;
  int least_events = 50;
  double least_fit = 0.45;
  int halvings = 6;
  double trusted_motion = 1.0;
  AlignmentOptions alignment;

  void declare(OptionSet& set);
};

/// Events of a span of time [µs], in time order.
struct Batch {
  std::span<const Event> events;
  std::int64_t from = 0, to = 0;
};

/// The motion of a batch.
struct Registration {
  enum class State {
    good,
    too_few_events,  ///< one of the slices has less than `least_events`
    not_converged,   ///< the iterations did not come to rest
    poor,            ///< too few events of the first slice found one in the last slice, or no more than by chance
  } state = State::too_few_events;
  Matrix3 A = Matrix3::Zero();  ///< of the motion [1/s] (motion_model.hpp)
  std::int64_t reference = 0;   ///< [µs] the batch's middle
  double motion = 0.0;          ///< [px] mean, over the batch
  double chance = 0.0;          ///< the fit that is to be expected where nothing belongs together
  Alignment alignment;
  bool grown = false;  ///< it was not found from the start that was given

  bool good() const { return state == State::good; }

  /// What is left of a fit of this batch's events without what chance gives: 1 where all fits, 0 where it fits no
  /// better than anything would. Among dense edges each event has one near it, whatever the motion.
  double beyond_chance(double fit) const { return chance < 1.0 ? (fit - chance) / (1.0 - chance) : 0.0; }

  /// Is it more to be believed than another one of the same batch?
  bool better_than(const Registration& other) const {
    return good() != other.good() ? good() : alignment.fit > other.alignment.fit;
  }
};

std::string to_string(Registration::State state);

/// Finds the motion of batches of events, by aligning the first slice of a batch with its last one.
class Registrar {
 public:
  Registrar(const Camera& camera, const RegistrationOptions& options);

  /// Starts from a motion that is expected; where that fails, or there is none, from nothing (grow()).
  Registration align(const Batch& batch, const std::optional<Matrix3>& expected);

  /// From nothing: the last part of the batch that is 2^-halvings of it, then ever longer ones, each started from rest
  /// and, where the one before moved by more than `trusted_motion`, from its motion: less is noise that would grow. The
  /// better fit is taken.
  Registration grow(const Batch& batch);

  /// From a motion, without a second try.
  Registration try_from(const Batch& batch, const Matrix3& start);

  const RayTable& rays() const { return rays_; }
  Aligner& aligner() { return aligner_; }
  const EventCloud& queries() const { return queries_; }

 private:
  RegistrationOptions options_;
  RayTable rays_;
  Aligner aligner_;
  EventCloud queries_, targets_;
};

}  // namespace evbench::str
