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
    not_converged,   ///< the iterations did not converge
    poor,            ///< too few events of the first slice match one in the last slice, or no more than by chance
  } state = State::too_few_events;
  Matrix3 A = Matrix3::Zero();  ///< of the motion [1/s] (motion_model.hpp)
  std::int64_t reference = 0;   ///< [µs] the batch's middle
  double motion = 0.0;          ///< [px] mean, over the batch
  double chance = 0.0;          ///< the fit that is expected without any correspondence
  Alignment alignment;
  bool grown = false;  ///< it was not found from the given start

  bool good() const { return state == State::good; }

  /// A fit of this batch's events with the part by chance removed: 1 for a perfect fit, 0 for a fit by chance. Among
  /// dense edges each event has a near neighbour under any motion.
  double beyond_chance(double fit) const { return chance < 1.0 ? (fit - chance) / (1.0 - chance) : 0.0; }

  /// Whether it is more reliable than another one of the same batch.
  bool better_than(const Registration& other) const {
    return good() != other.good() ? good() : alignment.fit > other.alignment.fit;
  }
};

std::string to_string(Registration::State state);

/// Finds the motion of batches of events, by aligning the first slice of a batch with its last one.
class Registrar {
 public:
  Registrar(const Camera& camera, const RegistrationOptions& options);

  /// Starts from the expected motion; where that fails or there is none, without a start (grow()).
  Registration align(const Batch& batch, const std::optional<Matrix3>& expected);

  /// Registers without a start: first the last 2^-halvings of the batch, then parts that double in length. Each part is
  /// started from rest and also from the previous part's motion where that is more than `trusted_motion`; less is noise
  /// that would grow. The better fit is taken.
  Registration grow(const Batch& batch);

  /// Registers from a start motion, without a second try.
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
