#pragma once

#include <cmath>

namespace evbench::smoother {

/// Loss ρ(s) on the squared norm s of a whitened residual, ρ'(0) = share. The cost is ½ Σ ρ(s).
class RobustLoss {
 public:
  enum class Kind { none, huber, cauchy };

  RobustLoss() = default;
  /// `width`: the residual norm [sigmas] at which the loss stops being quadratic. `share`: the share of an
  /// observation's information that counts.
  RobustLoss(Kind kind, double width, double share = 1.0) : kind_(kind), width_(width), share_(share) {}

  Kind kind() const { return kind_; }
  double width() const { return width_; }
  double share() const { return share_; }

  double value(double s) const { return share_ * shape(s); }

  /// ρ'(s): the weight of the residual in iteratively reweighted least squares.
  double weight(double s) const { return share_ * slope(s); }

  /// The share of an estimate's information that the weights state if errors are normal (Huber's sandwich, for
  /// two-dimensional residuals; 0.79 for a Cauchy loss of width 2). The inverse of Σ weight Jᵀ J times this share is
  /// the covariance of the estimate.
  double information_share() const;

 private:
  double shape(double s) const {
    const double w2 = width_ * width_;
    switch (kind_) {
      case Kind::huber: return s <= w2 ? s : 2.0 * width_ * std::sqrt(s) - w2;
      case Kind::cauchy: return w2 * std::log1p(s / w2);
      case Kind::none: break;
    }
    return s;
  }

  double slope(double s) const {
    switch (kind_) {
      case Kind::huber: return s <= width_ * width_ ? 1.0 : width_ / std::sqrt(s);
      case Kind::cauchy: return 1.0 / (1.0 + s / (width_ * width_));
      case Kind::none: break;
    }
    return 1.0;
  }

  Kind kind_ = Kind::none;
  double width_ = 1.0;
  double share_ = 1.0;
};

}  // namespace evbench::smoother
