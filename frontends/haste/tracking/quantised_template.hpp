#pragma once

#include <array>

#include "frontends/haste/tracking/template.hpp"

namespace evbench::haste {

/// A template scaled to a mass of kWindowSize events and rounded down to whole 1/kTemplateUnit of a weight of
/// Footprints: integers to sum up.
class QuantisedTemplate {
 public:
  /// One event has the mass kUnit · kTemplateUnit.
  static constexpr int kTemplateUnit = 8;

  QuantisedTemplate() = default;
  explicit QuantisedTemplate(const Template& original) {
    const double mass = original.mass();
    const auto scale = static_cast<float>(mass > 0.0 ? double{kWindowSize} * kUnit * kTemplateUnit / mass : 0.0);
    for (std::size_t i = 0; i < cells_.size(); ++i) cells_[i] = static_cast<int>(original.cells()[i] * scale);
  }

  const std::array<int, kPatchCells>& cells() const { return cells_; }

 private:
  std::array<int, kPatchCells> cells_{};
};

}  // namespace evbench::haste
