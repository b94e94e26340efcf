#pragma once

#include <cmath>

#include "core/geometry/types.hpp"

namespace evbench {

/// Turns residuals [px] into standard normal ones: the lower triangular matrix W with WᵀW = Σ⁻¹ [1/px].
struct Whitening {
  double xx = 1.0, yx = 0.0, yy = 1.0;

  Whitening() = default;
  Whitening(double inverse_sigma) : xx(inverse_sigma), yy(inverse_sigma) {}  // NOLINT: the same in all directions
  Whitening(double w00, double w10, double w11) : xx(w00), yx(w10), yy(w11) {}

  /// Of a residual, or of each column of its Jacobian.
  template <class Derived>
  typename Derived::PlainObject operator*(const Eigen::MatrixBase<Derived>& rows) const {
    static_assert(Derived::RowsAtCompileTime == 2);
    typename Derived::PlainObject result = rows;
    result.row(0) = xx * rows.row(0);
    result.row(1) = yx * rows.row(0) + yy * rows.row(1);
    return result;
  }
  /// The residual [px] that has this whitened one.
  Vector2 inverse(const Vector2& whitened) const {
    const double x = whitened.x() / xx;
    return {x, (whitened.y() - yx * x) / yy};
  }
  /// The geometric mean over all directions [1/px].
  double inverse_sigma() const;
  bool is_valid() const { return xx > 0.0 && yy > 0.0 && std::isfinite(xx + yy) && std::isfinite(yx); }
  Whitening scaled(double factor) const { return {factor * xx, factor * yx, factor * yy}; }
  bool operator==(const Whitening&) const = default;
};

/// The Gaussian error of a pixel: its covariance Σ [px²]. From a standard deviation it is the same in all directions,
/// and gives that back to the last digit.
class PixelNoise {
 public:
  PixelNoise() = default;   ///< of 1 px in all directions
  PixelNoise(double sigma)  // NOLINT: a standard deviation is such noise; a negative one is not valid
      : xx_(sigma * std::abs(sigma)), yy_(xx_) {}
  PixelNoise(double xx, double xy, double yy) : xx_(xx), xy_(xy), yy_(yy) {}
  explicit PixelNoise(const Matrix2& covariance) : PixelNoise(covariance(0, 0), covariance(1, 0), covariance(1, 1)) {}
  static PixelNoise of(const Whitening& whitening);  ///< the inverse of whitening()

  double xx() const { return xx_; }
  double xy() const { return xy_; }
  double yy() const { return yy_; }
  Matrix2 covariance() const;

  bool is_valid() const;  ///< finite and positive definite
  bool is_isotropic() const { return xx_ == yy_ && xy_ == 0.0; }
  /// The geometric mean over all directions [px]: σ² = √det Σ.
  double sigma() const;
  Whitening whitening() const;  ///< precondition: is_valid()
  bool operator==(const PixelNoise&) const = default;

  /// The noise of the sum of two independent errors.
  PixelNoise operator+(const PixelNoise& other) const { return {xx_ + other.xx_, xy_ + other.xy_, yy_ + other.yy_}; }
  /// The noise of the error times a factor.
  PixelNoise scaled(double factor) const {
    return {factor * factor * xx_, factor * factor * xy_, factor * factor * yy_};
  }
  /// The noise after a map of the image with this Jacobian.
  PixelNoise mapped(const Matrix2& jacobian) const;

 private:
  double xx_ = 1.0, xy_ = 0.0, yy_ = 1.0;
};

}  // namespace evbench
