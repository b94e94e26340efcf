#pragma once

#include <opencv2/core.hpp>

namespace evbench {

using Colour = cv::Vec3b;   ///< blue, green, red: OpenCV's order
using Picture = cv::Mat3b;  ///< an image of these

/// The colours of pictures.
struct Palette {
  Colour background, on, off, frame;
};

/// Red and blue on white.
Palette light_palette();
/// Lighter red and blue on almost black.
Palette dark_palette();

/// For OpenCV's drawing functions.
cv::Scalar scalar(const Colour& colour);

/// `share` of `b` in `a`, from 0 (a) to 1 (b).
Colour blend(const Colour& a, const Colour& b, double share);

}  // namespace evbench
