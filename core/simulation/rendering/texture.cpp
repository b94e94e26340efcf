#include "core/simulation/rendering/texture.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <opencv2/imgproc.hpp>

#include "core/support/index.hpp"

namespace evbench {
namespace {

int power_of_two(int size) {
  return std::clamp(static_cast<int>(std::bit_ceil(static_cast<unsigned>(std::max(size, 1)))), 8, 8192);
}

/// The index after mirroring at 0 and size, a power of two, again and again.
inline int mirrored(int index, int size) {
  index &= 2 * size - 1;
  return std::min(index, 2 * size - 1 - index);
}

/// The largest whole number that is not larger; for numbers that an int holds.
inline int floor_of(double x) {
  const int truncated = static_cast<int>(x);
  return truncated - (x < truncated);
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
  per_texel_square_ = static_cast<float>(texels_per_metre.minCoeff() * texels_per_metre.minCoeff());
  const auto add_level = [&] {
    pyramid_.push_back({level.cols,
                        level.rows,
                        texels_per_metre.x(),
                        texels_per_metre.y(),
                        {level.begin<float>(), level.end<float>()}});
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

void Texture::Level::at(std::span<const double> x, std::span<const double> y, std::span<float> values) const {
  std::array<float, kTogether> fx, fy;
  std::array<int, kTogether> upper_left, upper_right, lower_left, lower_right;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double u = x[i] * per_metre_x - 0.5, v = y[i] * per_metre_y - 0.5;
    const int left = floor_of(u), top = floor_of(v);
    fx[i] = static_cast<float>(u - left);
    fy[i] = static_cast<float>(v - top);
    const int x0 = mirrored(left, width), x1 = mirrored(left + 1, width);
    const int upper = mirrored(top, height) * width, lower = mirrored(top + 1, height) * width;
    upper_left[i] = upper + x0;
    upper_right[i] = upper + x1;
    lower_left[i] = lower + x0;
    lower_right[i] = lower + x1;
  }
  const float* const all = texels.data();
  for (std::size_t i = 0; i < x.size(); ++i) {
    const float a = all[upper_left[i]], b = all[upper_right[i]];
    const float c = all[lower_left[i]], d = all[lower_right[i]];
    const float up = a + fx[i] * (b - a), down = c + fx[i] * (d - c);
    values[i] = up + fy[i] * (down - up);
  }
}

/// The finer of the two levels that give a variance: level k has the variance 4^(k-1) texel². 0 for less than the first
/// has, the last one where no level has as much.
int Texture::level_of(float variance) const {
  const float quarters = 4.0F * variance * per_texel_square_;
  if (!(quarters > 1.0F)) return 0;
  const int last = static_cast<int>(pyramid_.size()) - 1;
  if (!(quarters < 1e30F)) return last;
  const int exponent = static_cast<int>(std::bit_cast<std::uint32_t>(quarters) >> 23) - 127;
  return std::min(exponent / 2, last);
}

void Texture::sample(std::span<const double> x, std::span<const double> y, std::span<const float> variances,
                     std::span<float> values) const {
  for (std::size_t first = 0; first < x.size();) {
    const int level = level_of(variances[first]);
    std::size_t count = 1;
    while (first + count < x.size() && count < kTogether && level_of(variances[first + count]) == level) ++count;
    sample_level(level, x.subspan(first, count), y.subspan(first, count), variances.subspan(first, count),
                 values.subspan(first, count));
    first += count;
  }
}

void Texture::sample_level(int level, std::span<const double> x, std::span<const double> y,
                           std::span<const float> variances, std::span<float> values) const {
  if (index(level) + 1 == pyramid_.size()) {
    std::ranges::fill(values, mean_);
    return;
  }
  pyramid_[index(level)].at(x, y, values);
  std::array<float, kTogether> coarse;
  pyramid_[index(level) + 1].at(x, y, std::span(coarse).first(x.size()));
  // The share of the coarser one is that which gives the variance wanted.
  const float scale = 4.0F * per_texel_square_ * std::ldexp(1.0F, -2 * level);
  for (std::size_t i = 0; i < values.size(); ++i) {
    const float share = std::max(0.0F, (variances[i] * scale - 1.0F) / 3.0F);
    values[i] += share * (coarse[i] - values[i]);
  }
}

float Texture::sample(double x, double y, float variance) const {
  float value = 0.0F;
  sample_level(level_of(variance), {&x, 1}, {&y, 1}, {&variance, 1}, {&value, 1});
  return value;
}

}  // namespace evbench
