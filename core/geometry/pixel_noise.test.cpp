#include "core/geometry/pixel_noise.hpp"

#include <limits>

#include "core/testing/catch2.hpp"

using namespace evbench;

namespace {

Matrix2 matrix(double xx, double xy, double yy) {
  Matrix2 result;
  result << xx, xy, xy, yy;
  return result;
}

}  // namespace

TEST_CASE("Noise of a standard deviation is the same in all directions, to the last digit") {
  for (const double sigma : {0.1, 0.3, 0.7, 1.3}) {
    const PixelNoise noise = sigma;
    CHECK(noise.is_valid());
    CHECK(noise.sigma() == sigma);
    CHECK(noise == PixelNoise(noise.covariance()));
    CHECK(noise.whitening() == Whitening(1.0 / sigma));
    const Vector2 error(0.4, -0.9);
    CHECK(noise.whitening() * error == Vector2((1.0 / sigma) * error));
  }
}

TEST_CASE("A covariance comes back, its whitening is its inverse's root, and sigma its area") {
  const Matrix2 covariance = matrix(0.5, -0.3, 0.4);
  const PixelNoise noise(covariance);
  CHECK(noise.is_valid());
  CHECK(noise.covariance().isApprox(covariance, 1e-14));
  const Matrix2 W = noise.whitening() * Matrix2(Matrix2::Identity());
  CHECK((W.transpose() * W).isApprox(covariance.inverse(), 1e-12));
  CHECK(noise.sigma() == Approx(std::pow(covariance.determinant(), 0.25)));
  CHECK(noise.whitening().inverse_sigma() == Approx(1.0 / noise.sigma()));
  const Vector2 error(0.4, -0.9);
  CHECK(noise.whitening().inverse(noise.whitening() * error).isApprox(error, 1e-12));
  CHECK(PixelNoise::of(noise.whitening()).covariance().isApprox(covariance, 1e-12));
}

TEST_CASE("Noise adds, scales and follows a map of the image as covariances do") {
  const PixelNoise noise(matrix(0.5, -0.3, 0.4));
  CHECK((noise + 0.2).covariance().isApprox(matrix(0.54, -0.3, 0.44), 1e-12));
  CHECK(noise.scaled(2.0).covariance().isApprox(matrix(2.0, -1.2, 1.6), 1e-12));
  Matrix2 J;
  J << 1.0, 0.5, -0.2, 2.0;
  CHECK(noise.mapped(J).covariance().isApprox(J * noise.covariance() * J.transpose(), 1e-12));
}

TEST_CASE("What is not positive definite or not finite is not valid noise") {
  CHECK_FALSE(PixelNoise(0.0).is_valid());
  CHECK_FALSE(PixelNoise(-1.0).is_valid());
  CHECK_FALSE(PixelNoise(std::numeric_limits<double>::infinity()).is_valid());
  CHECK_FALSE(PixelNoise(matrix(1.0, 1.0, 1.0)).is_valid());
  CHECK_FALSE(PixelNoise(matrix(1.0, 2.0, 1.0)).is_valid());
  CHECK_FALSE(PixelNoise(matrix(-1.0, 0.0, 1.0)).is_valid());
  CHECK_FALSE(PixelNoise(matrix(std::nan(""), 0.0, 1.0)).is_valid());
  CHECK(Whitening(2.0, -0.5, 1.0).is_valid());
  CHECK_FALSE(Whitening(2.0, std::nan(""), 1.0).is_valid());
  CHECK_FALSE(Whitening(0.0).is_valid());
}
