#pragma once

#include <cmath>

namespace evbench::gp_map {

/// Loss ρ(s) on the squared norm s of a whitened residual, ρ'(0) = 1. The cost is ½ Σ ρ(s).
class RobustLoss {
 public:
  enum class Kind { none, huber, cauchy };

  RobustLoss() = default;
  /// `width`: the residual norm [sigmas] where the loss turns from quadratic.
  RobustLoss(Kind kind, double width) : kind_(kind), width_(width) {}

  Kind kind() const { return kind_; }
  double width() const { return width_; }

  double value(double s) const {
    const double w2 = width_ * width_;
    switch (kind_) {
      case Kind::huber: return s <= w2 ? s : 2.0 * width_ * std::sqrt(s) - w2;
      case Kind::cauchy: return w2 * std::log1p(s / w2);
      case Kind::none: break;
    }
    return s;
  }

  /// ρ'(s): the weight of the residual in iteratively reweighted least squares.
  double weight(double s) const {
    switch (kind_) {
      case Kind::huber: return s <= width_ * width_ ? 1.0 : width_ / std::sqrt(s);
      case Kind::cauchy: return 1.0 / (1.0 + s / (width_ * width_));
      case Kind::none: break;
    }
    return 1.0;
  }

 private:
  Kind kind_ = Kind::none;
  double width_ = 1.0;
};

}  // namespace evbench::gp_map
