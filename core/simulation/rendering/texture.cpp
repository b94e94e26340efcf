#include "core/simulation/rendering/texture.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace evbench {
namespace {

int power_of_two(int size) {
  return std::clamp(static_cast<int>(std::bit_ceil(static_cast<unsigned>(std::max(size, 1)))), 8, 8192);
}

/// The index after mirroring at 0 and size, a power of two, again and again.
int mirrored(int index, int size) {
  index &= 2 * size - 1;
  return index < size ? index : 2 * size - 1 - index;
}

void blur(cv::Mat& picture, double variance) {
  cv::GaussianBlur(picture, picture, {}, std::sqrt(variance), 0.0, cv::BORDER_REFLECT);
}

}  // namespace

Texture::Texture(const cv::Mat& picture, const Vector2& size, double black) {
  const cv::Size scaled(power_of_two(picture.cols), power_of_two(picture.rows));
  cv::Mat level;
  cv::resize(picture, level, scaled, 0.0, 0.0, cv::INTER_LINEAR);
  level.convertTo(level, CV_32F, 1.0 / 255.0);
  cv::pow(level, 2.2, level);
  level = black + (1.0 - black) * level;
  mean_ = static_cast<float>(cv::mean(level)[0]);
  Vector2 texels_per_metre(scaled.width / size.x(), scaled.height / size.y());
  per_texel_square_ = texels_per_metre.minCoeff() * texels_per_metre.minCoeff();
  const auto add_level = [&] {
    pyramid_.push_back({level.cols, level.rows, texels_per_metre, {level.begin<float>(), level.end<float>()}});
  };
  add_level();
  // Variances [texel²]: a texel's 1/12 and the interpolation's 1/6 are there; halving the resolution by the mean of two
  // adds 1/4.
  blur(level, 1.0 - 1.0 / 4.0);
  add_level();
  while (std::min(level.cols, level.rows) > 1) {
    blur(level, 4.0 * (1.0 - 1.0 / 6.0) - (1.0 - 1.0 / 6.0) - 1.0 / 4.0);
    cv::Mat half;
    cv::resize(level, half, {}, 0.5, 0.5, cv::INTER_AREA);
    level = half;
    texels_per_metre *= 0.5;
    add_level();
  }
}

inline float Texture::Level::at(const Vector2& place) const {
  const double x = place.x() * texels_per_metre.x() - 0.5, y = place.y() * texels_per_metre.y() - 0.5;
  const double left = std::floor(x), top = std::floor(y);
  const auto fx = static_cast<float>(x - left), fy = static_cast<float>(y - top);
  const int column = static_cast<int>(left), row = static_cast<int>(top);
  const int x0 = mirrored(column, width), x1 = mirrored(column + 1, width);
  const float* const upper = values.data() + static_cast<std::ptrdiff_t>(mirrored(row, height)) * width;
  const float* const lower = values.data() + static_cast<std::ptrdiff_t>(mirrored(row + 1, height)) * width;
  const float a = upper[x0] + fx * (upper[x1] - upper[x0]), b = lower[x0] + fx * (lower[x1] - lower[x0]);
  return a + fy * (b - a);
}

float Texture::sample(const Vector2& place, double variance) const {
  // Level k has the variance 4^(k-1) texel²; the share of the coarser of two is that which gives the variance wanted.
  double quarters = 4.0 * variance * per_texel_square_;
  if (!(quarters > 1.0)) return pyramid_[0].at(place);
  std::size_t fine = 0;
  for (; quarters >= 4.0 && fine + 1 < pyramid_.size(); quarters *= 0.25) ++fine;
  if (fine + 1 >= pyramid_.size()) return mean_;
  const auto coarser = static_cast<float>((quarters - 1.0) / 3.0);
  const float value = pyramid_[fine].at(place);
  return value + coarser * (pyramid_[fine + 1].at(place) - value);
}

}  // namespace evbench
