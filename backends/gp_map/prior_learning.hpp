#pragma once

#include <map>
#include <optional>
#include <span>
#include <vector>

#include "backends/gp_map/engine/engine.hpp"
#include "backends/gp_map/time_span.hpp"

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

/// Of the prior over an interval; `joint`: covariance of the states at both its ends.
PriorEvidence evidence_of(const GpInterval& interval, const Matrix24& joint, const Vector6& qc);

/// The density of now, from what was seen of late: over a window that ends now, so that it follows a camera that goes
/// from slow to violent and back.
class RecentPrior {
 public:
  /// `window`: of what the density follows [s]; `memory`: of what it falls back to where the window shows little;
  /// `guess`: before there is any evidence.
  RecentPrior(double window, double memory, const Vector6& guess) : window_(window), memory_(memory), guess_(guess) {}

  /// Evidence of the intervals `first`, first + 1, ... up to the newest, in place of what was known of these; those
  /// before are settled.
  void take(int first, const std::vector<PriorEvidence>& evidence);

  /// Of the intervals that are not settled, by number.
  const std::map<int, PriorEvidence>& recent() const { return recent_; }

  Vector6 at(double t) const;

 private:
  double window_, memory_;
  Vector6 guess_;
  PriorEvidence settled_, remembered_;   ///< of intervals that are not looked at any more
  std::map<int, PriorEvidence> recent_;  ///< by interval
};

/// Learns the prior of an engine while running.
class PriorLearner {
 public:
  PriorLearner(double window, double memory) : window_(window), memory_(memory) {}

  /// After an update: sets the densities of the newest intervals and of those to come.
  void follow(Engine& engine);

 private:
  void take_evidence(Engine& engine);

  double window_, memory_;
  std::optional<RecentPrior> prior_;
  double followed_until_ = -1e300;  ///< [s]
};

/// How much more than the prior draws together its expansions push apart, by interval; 0 of what is marginalised.
std::vector<double> surplus_expansions(Engine& engine);

/// Learns the prior of the intervals in this span that are still estimated, from these and from what came after it. The
/// expansions balance it, with this surplus by interval: where only a part is balanced anew, it gets another scale than
/// the rest.
void learn_prior(Engine& engine, const TimeSpan& span, std::span<const double> surplus = {});

}  // namespace evbench::gp_map
