#pragma once

#include <opencv2/core/mat.hpp>
#include <span>
#include <vector>

#include "core/geometry/types.hpp"

namespace evbench {

/// A grey picture on a surface, which it covers without seams by being mirrored at its edges repeatedly. Values are
/// linear intensity; a pyramid of pictures, each blurred twice as much, serves views from afar.
class Texture {
 public:
  /// `picture`: grey values of 8 bits as displays show them (gamma 2.2), any size; scaled to powers of two, at least 8
  /// and at most 8192. `size`: of the picture on the surface [m]; its top left corner is at (0, 0).
  /// `black`: intensity of grey value 0, if that of 255 is 1. No ink is black, and no photodiode is without dark
  /// current.
  Texture(const cv::Mat& picture, const Vector2& size, double black);

  /// Intensities in (0, 1] at places [m], averaged with Gaussians of these variances [m²], at least with the smallest
  /// that a texel can show. All spans have the same length.
  void sample(std::span<const double> x, std::span<const double> y, std::span<const float> variances,
              std::span<float> values) const;
  float sample(double x, double y, float variance) const;

  /// Mean intensity of the whole picture.
  float mean() const { return mean_; }

 private:
  struct Level {
    int width = 0, height = 0;        ///< [texels]; powers of two
    double per_metre_x, per_metre_y;  ///< [texels/m]
    std::vector<float> texels;  ///< by rows

    /// Bilinear. At most kTogether places.
    void at(std::span<const double> x, std::span<const double> y, std::span<float> values) const;
  };
  static constexpr std::size_t kTogether = 64;
  void sample_level(int level, std::span<const double> x, std::span<const double> y, std::span<const float> variances,
                    std::span<float> values) const;
  int level_of(float variance) const;

  /// The first level has the picture's texels and a variance of 1/4 texel², the blur of texels and bilinear
  /// interpolation themselves. The second has the same texels and a variance of 1 texel². From then on both double in
  /// width.
  std::vector<Level> pyramid_;
  float per_texel_square_ = 0.0F;  ///< one over the square of a texel's larger side [1/m²]
  float mean_ = 0.0F;
};

}  // namespace evbench
