#pragma once

#include <limits>
#include <map>
#include <optional>
#include <vector>

#include "backends/gp_map/engine/engine.hpp"

namespace evbench::gp_map {

/// What one interval, or several, tell of the power spectral density of the WNOA prior, axis by axis: with e the
/// prior's residual, Σ_e its posterior covariance and Q_1 = Q/qc, a maximum of the marginal likelihood fulfils
///   qc = Σ eᵀ Q_1⁻¹ e / Σ (2 − tr(Q_1⁻¹ Σ_e)/qc),
/// squares over the degrees of freedom that the data determine (MacKay 1992, for the expected squares of Wong et al.,
/// RA-L 2020). EM has the same fixed points, and crawls where the prior determines most.
struct PriorEvidence {
  double t = 0.0;  ///< [s]
  Vector6 square = Vector6::Zero();
  Vector6 freedom = Vector6::Zero();  ///< 0 to 2 an interval

  /// Adds another one's, which fades with its distance in time, exp(−|Δt|/window).
  void add(const PriorEvidence& other, double window);

  /// The density, where `weight` degrees of freedom speak for a guess.
  Vector6 qc(const Vector6& guess, double weight) const;

  /// eᵀ Q⁻¹ e of the translations: the force with which the prior draws the world together (FactorGraph::expansions).
  double expansion(const Vector6& qc) const;

  /// The density of all three rotations, and of all three translations: the guess for an axis that shows little.
  Vector6 common_qc(const Vector6& guess, double weight) const;
};

/// Learns the prior while running, over a window that ends now, so that it follows a camera that goes from slow to
/// violent and back.
class PriorLearner {
 public:
  /// `window`: of what the density follows [s]; `memory`: of what it falls back to where the window shows little.
  PriorLearner(double window, double memory) : window_(window), memory_(memory) {}

  /// After an update: sets the densities of the newest intervals and of those to come.
  void follow(Engine& engine);

 private:
  void take_evidence(Engine& engine);
  Vector6 qc_at(double t) const;

  double window_, memory_;
  PriorEvidence settled_, remembered_;   ///< of intervals that are not looked at any more
  std::optional<Vector6> begin_;         ///< the density that was set before there was any evidence
  std::map<int, PriorEvidence> recent_;  ///< by interval
  double followed_until_ = -1e300;       ///< [s]
};

/// Learns the prior of the intervals that are still estimated, with a lag those within it, from all of them, and sets it
/// up to the time `until` [s].
void learn_prior(Engine& engine, double until = std::numeric_limits<double>::infinity());

}  // namespace evbench::gp_map
