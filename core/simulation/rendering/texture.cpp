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

}  // namespace

Texture::Texture(const cv::Mat& picture, const Vector2& size, double black) {
  const cv::Size scaled(power_of_two(picture.cols), power_of_two(picture.rows));
  cv::Mat level;
  cv::resize(picture, level, scaled, 0.0, 0.0, cv::INTER_LINEAR);
  level.convertTo(level, CV_32F, 1.0 / 255.0);
  cv::pow(level, 2.2, level);
  level = black + (1.0 - black) * level;
  mean_ = static_cast<float>(cv::mean(level)[0]);
  texels_per_metre_ = {scaled.width / size.x(), scaled.height / size.y()};
  texel_ = 1.0 / texels_per_metre_.minCoeff();
  while (true) {
    pyramid_.push_back({level.cols, level.rows, {level.begin<float>(), level.end<float>()}});
    if (std::min(level.cols, level.rows) == 1) break;
    cv::Mat half;
    cv::resize(level, half, {}, 0.5, 0.5, cv::INTER_AREA);
    level = half;
  }
}

float Texture::level(double width) const { return std::log2(static_cast<float>(width / texel_)); }

float Texture::sample(const Vector2& place, float level) const {
  if (level >= static_cast<float>(pyramid_.size() - 1)) return mean_;
  level = std::max(level, 0.0F);
  const auto fine = static_cast<std::size_t>(level);
  const float weight = level - static_cast<float>(fine);
  const Vector2 texel = place.cwiseProduct(texels_per_metre_) * std::ldexp(1.0, -static_cast<int>(fine));
  const float value = pyramid_[fine].at(texel.x() - 0.5, texel.y() - 0.5);
  if (weight == 0.0F) return value;
  const float coarse = pyramid_[fine + 1].at(0.5 * texel.x() - 0.5, 0.5 * texel.y() - 0.5);
  return value + weight * (coarse - value);
}

float Texture::Picture::at(double x, double y) const {
  const double left = std::floor(x), top = std::floor(y);
  const auto fx = static_cast<float>(x - left), fy = static_cast<float>(y - top);
  const int column = static_cast<int>(left), row = static_cast<int>(top);
  const int x0 = mirrored(column, width), x1 = mirrored(column + 1, width);
  const float* const upper = values.data() + static_cast<std::ptrdiff_t>(mirrored(row, height)) * width;
  const float* const lower = values.data() + static_cast<std::ptrdiff_t>(mirrored(row + 1, height)) * width;
  const float a = upper[x0] + fx * (upper[x1] - upper[x0]), b = lower[x0] + fx * (lower[x1] - lower[x0]);
  return a + fy * (b - a);
}

}  // namespace evbench
