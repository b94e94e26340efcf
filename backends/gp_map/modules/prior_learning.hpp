#pragma once

#include <map>
#include <optional>
#include <span>
#include <vector>

#include "backends/gp_map/smoother.hpp"
#include "core/smoother/time_span.hpp"

namespace evbench::gp_map {

/// Evidence of one or more intervals about the power spectral density of the motion prior, for each axis. With e the
/// prior's residual of n orders, Σ_e its posterior covariance and Q_1 = Q/qc, a maximum of the marginal likelihood
/// fulfils
///   qc = Σ eᵀ Q_1⁻¹ e / Σ (n − tr(Q_1⁻¹ Σ_e)/qc),
/// squares over the degrees of freedom that the data determine (MacKay 1992, for the expected squares of Wong et al.,
/// RA-L 2020). EM has the same fixed points, but converges slowly where the prior determines most.
struct PriorEvidence {
  double t = 0.0;  ///< [s]
  Vector6 square = Vector6::Zero();
  Vector6 freedom = Vector6::Zero();  ///< 0 to n an interval

  /// Adds other evidence with a weight that fades with its distance in time, exp(−|Δt|/window).
  void add(const PriorEvidence& other, double window);

  /// The density; a guess counts like `weight` degrees of freedom.
  Vector6 qc(const Vector6& guess, double weight) const;

  /// eᵀ Q⁻¹ e of the translations: the force with which the prior contracts the world (FactorGraph::expansions).
  double expansion(const Vector6& qc) const;

  /// The density of all three rotations, and of all three translations: the guess for an axis with little evidence.
  Vector6 common_qc(const Vector6& guess, double weight) const;
};

/// Evidence of the prior over an interval; `joint`: covariance of the states at both its ends.
PriorEvidence evidence_of(const GpInterval& interval, const PairMatrix& joint, const Vector6& qc);

/// The present density from recent evidence: over a short window, so that it follows a camera that changes between slow
/// and aggressive motion.
class RecentPrior {
 public:
  /// `window`: time constant of the density [s]; `memory`: time constant of the density that is used where the window
  /// has little evidence [s]; `guess`: the density before any evidence.
  RecentPrior(double window, double memory, const Vector6& guess) : window_(window), memory_(memory), guess_(guess) {}

  /// Sets the evidence of the intervals `first`, first + 1, ... up to the newest one. Evidence of intervals before is
  /// final.
  void take(int first, const std::vector<PriorEvidence>& evidence);

  /// Evidence that is not final, by interval.
  const std::map<int, PriorEvidence>& recent() const { return recent_; }

  Vector6 at(double t) const;

 private:
  double window_, memory_;
  Vector6 guess_;
  PriorEvidence older_, remembered_;     ///< of intervals whose evidence is final
  std::map<int, PriorEvidence> recent_;  ///< by interval
};

/// Estimates the prior of an smoother while running.
class PriorLearner {
 public:
  PriorLearner(double window, double memory) : window_(window), memory_(memory) {}

  /// Call after an update: sets the densities of the newest intervals and of future ones.
  void follow(Smoother& smoother);

 private:
  void take_evidence(Smoother& smoother);

  double window_, memory_;
  std::optional<RecentPrior> prior_;
  double followed_until_ = -1e300;  ///< [s]
};

/// By how much the expansions exceed the contraction by the prior, by interval; 0 for marginalised ones.
std::vector<double> surplus_expansions(Smoother& smoother);

/// Estimates the prior of the intervals in this span that are still estimated, from these and from later ones. The
/// expansions balance it, plus this surplus by interval: a part that alone is balanced again would get another scale
/// than the rest.
void learn_prior(Smoother& smoother, const TimeSpan& span, std::span<const double> surplus = {});

}  // namespace evbench::gp_map
