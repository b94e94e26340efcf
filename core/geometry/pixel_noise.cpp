#include "core/geometry/pixel_noise.hpp"

#include <cmath>

namespace evbench {

double Whitening::inverse_sigma() const { return std::sqrt(xx * yy); }

PixelNoise PixelNoise::of(const Whitening& whitening) {
  const double x = 1.0 / whitening.xx, y = 1.0 / whitening.yy;  // of the lower triangular root of Σ
  const double skew = -whitening.yx * x * y;
  return {x * x, x * skew, skew * skew + y * y};
}

Matrix2 PixelNoise::covariance() const {
  Matrix2 result;
  result << xx_, xy_, xy_, yy_;
  return result;
}

bool PixelNoise::is_valid() const {
  const double determinant = xx_ * yy_ - xy_ * xy_;
  return xx_ > 0.0 && yy_ > 0.0 && determinant > 0.0 && std::isfinite(determinant);
}

double PixelNoise::sigma() const { return std::sqrt(std::sqrt(xx_ * yy_ - xy_ * xy_)); }

Whitening PixelNoise::whitening() const {
  const double x = 1.0 / std::sqrt(xx_), y = 1.0 / std::sqrt(yy_ - xy_ * xy_ / xx_);
  return {x, -xy_ / xx_ * y, y};
}

PixelNoise PixelNoise::mapped(const Matrix2& jacobian) const {
  return PixelNoise(Matrix2(jacobian * covariance() * jacobian.transpose()));
}

}  // namespace evbench
