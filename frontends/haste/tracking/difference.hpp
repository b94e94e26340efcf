#pragma once

#include <memory>

#include "frontends/haste/tracking/hypothesis_lanes.hpp"
#include "frontends/haste/tracking/sample_table.hpp"
#include "frontends/haste/tracking/scoring_input.hpp"

namespace evbench::haste {

/// Scores of the variants haste_difference and haste_difference_star: −Σ over the patch of (template − model)², where
/// the model of a hypothesis is the window's events in its patch, both with the mass of a full window. With t = the
/// template's cells and m = the model's,
///   Σ (t − m)² = Σ t² − 2 Σ t m + Σ m²,
/// and an event changes Σ t m and Σ m² in its four cells alone. All are integers, so that an event takes away exactly
/// what it added, and a hypothesis' model survives a change of state that leaves the hypothesis in place.
class Difference {
 public:
  /// follow_template: the template is the newest at each event, not that of the last change of state
  /// (haste_difference).
  explicit Difference(bool follow_template);

  void start(const ScoringInput& input);
  void change_to(std::size_t h, const ScoringInput& input);
  void update(const Event& newest, const Event& replaced, const ScoringInput& input);

  const Lanes<Double4>& raw() const { return scores_; }
  double unit(const ScoringInput& /*input*/) const {
    constexpr double kCells = double{kWindowSize} * kUnit * QuantisedTemplate::kTemplateUnit;
    return 1.0 / (kCells * kCells);
  }

 private:
  using Model = std::array<int, kPatchCells>;  ///< in weights of Footprints

  void make_model(std::size_t h, const ScoringInput& input);
  void compare(const ScoringInput& input);
  void score();

  bool follow_template_;
  double template_square_ = 0.0;  ///< Σ t²
  HypothesisFootprints footprints_;
  std::unique_ptr<std::array<Model, kHypotheses>> models_;
  std::array<int*, kHypotheses> model_of_{};  ///< the cells of each hypothesis' model
  Lanes<Double4> squares_;                    ///< Σ m²
  Lanes<Double4> products_;                   ///< Σ t m
  SampleTable samples_;                       ///< unless the template is followed
  Lanes<Double4> scores_;
};

}  // namespace evbench::haste
