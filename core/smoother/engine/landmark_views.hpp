#pragma once

#include <vector>

#include "core/smoother/engine/observation_geometry.hpp"

namespace evbench::smoother {

/// The observations of one landmark with the poses at which they were made, for moving the landmark while the poses
/// stay fixed. The poses are copied at construction; a reference to the graph is kept.
class LandmarkViews {
 public:
  LandmarkViews(const FactorGraph& graph, int landmark);

  /// ½ Σ ρ of the landmark's observations and prior for the landmark at this position.
  double cost(const Vector3& position) const;

  /// H and g of this cost with respect to the landmark alone.
  struct System {
    Matrix3 H = Matrix3::Zero();
    Vector3 g = Vector3::Zero();
  };
  System linearise(const Vector3& position) const;

 private:
  /// Up to kLanes observations of one interval.
  struct View {
    Matrix3 R;  ///< (R, p): from the world into the camera at the interval's first state
    Vector3 p;
    lanes::Motion motion;
    lanes::Measured observed;
  };
  lanes::Residual residual_at(const View& view, const Vector3& position) const;

  const FactorGraph& graph_;
  LandmarkPrior prior_;
  std::vector<View> views_;
};

}  // namespace evbench::smoother
