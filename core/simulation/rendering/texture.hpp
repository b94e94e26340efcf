#pragma once

#include <array>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "core/geometry/types.hpp"

namespace evbench {

/// A grey picture on a surface, which it covers by being mirrored at its edges again and again, without seams: linear
/// intensity, with a pyramid of pictures of half the resolution each for looking at it from afar.
class Texture {
 public:
  /// `picture`: grey values of 8 bits as displays show them (gamma 2.2), any size; scaled to powers of two, at least 8
  /// and at most 8192. `size`: of the picture on the surface [m]; its top left corner is at (0, 0).
  /// `black`: intensity of grey value 0, if that of 255 is 1: no ink is black, and no photodiode without dark current.
  Texture(const cv::Mat& picture, const Vector2& size, double black);

  /// Intensity in (0, 1] at a place [m], averaged over texels of 2^level times the picture's; the level need not be
  /// whole (trilinear). No averaging below level 0.
  float sample(const Vector2& place, float level) const;

  /// The level whose texels are `width` [m] wide.
  float level(double width) const;

  /// Of the whole picture.
  float mean() const { return mean_; }

 private:
  struct Picture {
    int width = 0, height = 0;
    std::vector<float> values;

    float at(double x, double y) const;  ///< bilinear; pixels
  };

  std::vector<Picture> pyramid_;
  Vector2 texels_per_metre_;
  double texel_;  ///< the larger side of a texel [m]
  float mean_ = 0.0F;
};

}  // namespace evbench
