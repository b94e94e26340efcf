#include "frontends/str/registration/testing/contrast.hpp"

#include <algorithm>
#include <cmath>

#include "core/simulation/random.hpp"

namespace evbench::str::testing {

double contrast(const EventCloud& cloud, const Matrix3& A, double focal_length) {
  const auto f = static_cast<float>(focal_length);
  EventCloud dithered = cloud;
  Random random(1);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    dithered.x[i] += static_cast<float>(random.uniform(-0.5, 0.5)) / f;
    dithered.y[i] += static_cast<float>(random.uniform(-0.5, 0.5)) / f;
  }
  const auto [left, right] = std::ranges::minmax(cloud.x);
  const auto [top, bottom] = std::ranges::minmax(cloud.y);
  const int width = static_cast<int>(f * (right - left)) + 2, height = static_cast<int>(f * (bottom - top)) + 2;
  std::vector<float> image(static_cast<std::size_t>(width) * static_cast<std::size_t>(height)), x, y;
  warp(dithered, A, x, y);
  double sum = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const float u = f * (x[i] - left), v = f * (y[i] - top);
    if (!(u >= 0.0F && v >= 0.0F && u < static_cast<float>(width - 1) && v < static_cast<float>(height - 1))) continue;
    const int column = static_cast<int>(u), row = static_cast<int>(v);
    const float a = u - static_cast<float>(column), b = v - static_cast<float>(row);
    float* pixel = &image[static_cast<std::size_t>(row * width + column)];
    pixel[0] += (1 - a) * (1 - b);
    pixel[1] += a * (1 - b);
    pixel[width] += (1 - a) * b;
    pixel[width + 1] += a * b;
    sum += 1.0;
  }
  double squares = 0.0;
  for (const float value : image) squares += static_cast<double>(value) * static_cast<double>(value);
  const auto n = static_cast<double>(image.size());
  return squares / n - (sum / n) * (sum / n);
}

MotionParameters maximise_contrast(const EventCloud& cloud, MotionModel model, MotionParameters start, double step,
                                   double focal_length) {
  constexpr double kSmallest = 1e-3;  // of the first step
  double best = contrast(cloud, generator_matrix(model, start), focal_length);
  for (double size = step; size > kSmallest * step; size *= 0.5) {
    for (bool better = true; better;) {
      better = false;
      for (Eigen::Index k = 0; k < start.size(); ++k) {
        for (const double sign : {-1.0, 1.0}) {
          MotionParameters tried = start;
          tried[k] += sign * size;
          const double value = contrast(cloud, generator_matrix(model, tried), focal_length);
          if (value <= best) continue;
          best = value;
          start = tried;
          better = true;
        }
      }
    }
  }
  return start;
}

}  // namespace evbench::str::testing
