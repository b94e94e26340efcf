#include "core/simulation/rendering/renderer.hpp"

#include <algorithm>
#include <cmath>

#include "core/support/parallel.hpp"

namespace evbench {
namespace {

constexpr int kEdgeRays = 32;

/// The sum of three kernels has the variance blur²: the weights (1, 2, 1) of samples `s` apart (s²/2), linear
/// interpolation between texels of width s (s²/6), and the texels themselves (s²/12).
constexpr double kSpacing = 1.0 / 0.8660254037844386;

/// The number's bits behind the binary point, mirrored at it: van der Corput's sequence.
double van_der_corput(int i) {
  double value = 0.0;
  for (double digit = 0.5; i > 0; i /= 2, digit *= 0.5) value += digit * (i % 2);
  return value;
}

/// Inverse of the standard normal distribution, by bisection.
double normal_quantile(double p) {
  double low = -8.0, high = 8.0;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (0.5 * std::erfc(-middle * M_SQRT1_2) < p ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

/// By how many the samples along a side of a pixel's footprint are multiplied when it is longer than the other.
int samples(double side, double other) { return std::clamp(static_cast<int>(std::lround(side / other)), 1, 4); }

float log_of(float intensity) { return std::log(intensity); }

}  // namespace

Renderer::Renderer(const Camera& camera, const std::vector<Surface>& surfaces, const Texture& texture, double blur)
    : camera_(camera), surfaces_(&surfaces), texture_(&texture), blur_(blur) {
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x) rays_.push_back(make_ray(Vector2(x, y)));
  }
  for (int i = 0; i < kEdgeRays; ++i) {  // Hammersley's points, spread as a Gaussian
    spread_.push_back(
        blur * Vector2(normal_quantile((i + 0.5) / kEdgeRays), normal_quantile(van_der_corput(i) + 0.5 / kEdgeRays)));
  }
}

Renderer::Ray Renderer::make_ray(const Vector2& pixel) const {
  constexpr double h = 0.5;
  Ray ray{{0.0, 0.0, 1.0}, Matrix2::Zero(), false};
  const std::optional<Vector2> centre = camera_.undistort(pixel);
  if (!centre) return ray;
  for (Eigen::Index axis = 0; axis < 2; ++axis) {
    const Vector2 step = h * Vector2::Unit(axis);
    const std::optional<Vector2> before = camera_.undistort(pixel - step), after = camera_.undistort(pixel + step);
    if (!before || !after) return ray;
    ray.jacobian.col(axis) = (camera_.pinhole.ray(*after) - camera_.pinhole.ray(*before)).head<2>() / (2.0 * h);
  }
  ray.centre = camera_.pinhole.ray(*centre);
  ray.valid = true;
  return ray;
}

void Renderer::render(const SE3& T_world_camera, int threads, Frame& frame) const {
  frame.log_intensity.resize(rays_.size());
  frame.hits.resize(rays_.size());
  frame.edge.resize(rays_.size());
  const View seen = view(T_world_camera);
  const int width = camera_.width, height = camera_.height;
  const auto index_of = [width](int x, int y) {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
  };
  parallel_for(threads, height, [&](int y) {
    for (std::size_t i = index_of(0, y); i < index_of(0, y + 1); ++i) {
      frame.hits[i] = rays_[i].valid ? seen.hit(rays_[i].centre).value_or(Hit{}) : Hit{};
    }
  });
  parallel_for(threads, height, [&](int y) {
    for (int x = 0; x < width; ++x) {
      const std::size_t i = index_of(x, y);
      const Hit& hit = frame.hits[i];
      bool edge = false;
      for (int v = std::max(y - 1, 0); v <= std::min(y + 1, height - 1); ++v) {
        for (int u = std::max(x - 1, 0); u <= std::min(x + 1, width - 1); ++u) {
          const Hit& other = frame.hits[index_of(u, v)];
          edge = edge || other.surface != hit.surface || other.face != hit.face;
        }
      }
      frame.edge[i] = edge;
      const Ray& ray = rays_[i];
      frame.log_intensity[i] = log_of(!ray.valid ? texture_->mean()
                                      : edge     ? intensity_at_edge(seen, ray)
                                                 : intensity(seen, hit, ray));
    }
  });
}

float Renderer::pixel(const View& view, std::size_t index, bool edge) const {
  const Ray& ray = rays_[index];
  if (!ray.valid) return log_of(texture_->mean());
  if (edge) return log_of(intensity_at_edge(view, ray));
  return log_of(intensity(view, view.hit(ray.centre).value_or(Hit{}), ray));
}

float Renderer::intensity(const View& view, const Hit& hit, const Ray& ray) const {
  if (hit.surface < 0) return texture_->mean();
  const View::Place place = view.place(hit, ray.centre);
  const Matrix2 step = blur_ * kSpacing * (place.jacobian * ray.jacobian);  // columns: along the image's axes
  // Where the surface is foreshortened, the long axis of a pixel's footprint gets more samples of finer texels.
  const double width = step.col(0).norm(), height = step.col(1).norm();
  const int across = samples(width, height), down = samples(height, width);
  const float level = texture_->level(std::max(width / across, height / down));
  const Vector2 right = step.col(0) / across, below = step.col(1) / down;
  float sum = 0.0F;
  for (int i = 1 - 2 * down; i < 2 * down; ++i) {
    for (int j = 1 - 2 * across; j < 2 * across; ++j) {
      const auto weight = static_cast<float>((2 * down - std::abs(i)) * (2 * across - std::abs(j)));
      sum += weight * texture_->sample(place.texture + i * below + j * right, level);
    }
  }
  return sum / static_cast<float>(16 * down * down * across * across);
}

float Renderer::intensity_at_edge(const View& view, const Ray& ray) const {
  constexpr double footprint = 0.3;  // of a ray, as a share of the blur
  float sum = 0.0F;
  for (const Vector2& offset : spread_) {
    Vector3 cast = ray.centre;
    cast.head<2>() += ray.jacobian * offset;
    const std::optional<Hit> hit = view.hit(cast);
    if (!hit) {
      sum += texture_->mean();
      continue;
    }
    const View::Place place = view.place(*hit, cast);
    const Matrix2 step = footprint * blur_ * (place.jacobian * ray.jacobian);
    const double width = std::sqrt(std::max(step.col(0).squaredNorm(), step.col(1).squaredNorm()));
    sum += texture_->sample(place.texture, texture_->level(width));
  }
  return sum / kEdgeRays;
}

}  // namespace evbench
