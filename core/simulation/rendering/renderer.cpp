#include "core/simulation/rendering/renderer.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/support/index.hpp"
#include "core/support/parallel.hpp"

namespace evbench {
namespace {

constexpr int kEdgeRays = 32;

/// Axes of a pixel's footprint that differ by less than this are taken as equal, of their squares.
constexpr double kRound = 1.25;

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
  constexpr double kH = 0.5;
  const Ray blind{Vector2::Constant(std::numeric_limits<double>::quiet_NaN()), Eigen::Matrix2f::Zero()};
  const std::optional<Vector2> centre = camera_.undistort(pixel);
  if (!centre) return blind;
  Ray ray{camera_.pinhole.ray(*centre).head<2>(), {}};
  for (Eigen::Index axis = 0; axis < 2; ++axis) {
    const Vector2 step = kH * Vector2::Unit(axis);
    const std::optional<Vector2> before = camera_.undistort(pixel - step), after = camera_.undistort(pixel + step);
    if (!before || !after) return blind;
    const Vector3 slope = (camera_.pinhole.ray(*after) - camera_.pinhole.ray(*before)) / (2.0 * kH);
    ray.jacobian.col(axis) = slope.head<2>().cast<float>();
  }
  return ray;
}

void Renderer::render(const SE3& T_world_camera, int threads, Frame& frame) const {
  frame.log_intensity.resize(rays_.size());
  frame.hits.resize(rays_.size());
  frame.edge.resize(rays_.size());
  const View seen = view(T_world_camera);
  const int width = camera_.width, height = camera_.height;
  const auto row = [width](int y) { return static_cast<std::size_t>(y) * static_cast<std::size_t>(width); };
  std::vector<std::uint8_t> even(static_cast<std::size_t>(height));  // rows that see a single face
  parallel_for(threads, height, [&](int y) {
    for (std::size_t i = row(y); i < row(y + 1); ++i) {
      frame.hits[i] = rays_[i].valid() ? seen.hit(rays_[i].direction()).value_or(Hit{}) : Hit{};
    }
    const auto begin = frame.hits.begin() + static_cast<std::ptrdiff_t>(row(y));
    even[index(y)] = std::all_of(begin, begin + width, [&](const Hit& h) { return h.same_face(*begin); });
  });
  parallel_for(threads, height, [&](int y) {
    mark_edges(y, even, frame);
    for (std::size_t i = row(y); i < row(y + 1); ++i) {
      const Ray& ray = rays_[i];
      frame.log_intensity[i] = log_of(!ray.valid()    ? texture_->mean()
                                      : frame.edge[i] ? intensity_at_edge(seen, ray)
                                                      : intensity(seen, frame.hits[i], ray));
    }
  });
}

/// Of a row, with the rows above and below.
void Renderer::mark_edges(int y, const std::vector<std::uint8_t>& even, Frame& frame) const {
  const int width = camera_.width, top = std::max(y - 1, 0), bottom = std::min(y + 1, camera_.height - 1);
  const auto index_of = [width](int x, int v) {
    return static_cast<std::size_t>(v) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
  };
  bool same = true;
  for (int v = top; v <= bottom; ++v) {
    same = same && even[index(v)] && frame.hits[index_of(0, v)].same_face(frame.hits[index_of(0, y)]);
  }
  for (int x = 0; x < width; ++x) {
    bool edge = false;
    for (int v = top; v <= bottom && !same; ++v) {
      for (int u = std::max(x - 1, 0); u <= std::min(x + 1, width - 1); ++u) {
        edge = edge || !frame.hits[index_of(u, v)].same_face(frame.hits[index_of(x, y)]);
      }
    }
    frame.edge[index_of(x, y)] = edge;
  }
}

float Renderer::pixel(const View& view, std::size_t index, bool edge) const {
  const Ray& ray = rays_[index];
  if (!ray.valid()) return log_of(texture_->mean());
  if (edge) return log_of(intensity_at_edge(view, ray));
  return log_of(intensity(view, view.hit(ray.direction()).value_or(Hit{}), ray));
}

float Renderer::intensity(const View& view, const Hit& hit, const Ray& ray) const {
  if (hit.surface < 0) return texture_->mean();
  const View::Place place = view.place(hit, ray.direction());
  const Matrix2 step = blur_ * (place.jacobian * ray.jacobian.cast<double>());
  const Matrix2 covariance = step * step.transpose();
  const double mean = 0.5 * covariance.trace();
  const double difference = std::sqrt(std::max(0.0, mean * mean - covariance.determinant()));
  const double longer = mean + difference, shorter = std::max(mean - difference, 1e-3 * longer);
  if (longer < kRound * shorter) return texture_->sample(place.texture, mean);
  // A long footprint is a row of round ones.
  return row_of_samples(place.texture, covariance, longer, shorter);
}

/// Round samples along the longer axis of a footprint, `longer` and `shorter` the variances along its axes. With
/// weights 1, 2, ..., n, ..., 2, 1 and the distance d between them their places have the variance d² (n² − 1) / 6.
float Renderer::row_of_samples(const Vector2& centre, const Matrix2& covariance, double longer, double shorter) const {
  constexpr int kMost = 8;
  constexpr double kApart = 1.6;  // so many standard deviations of one at most
  const auto spread = [](int n) { return (n * n - 1) / 6.0; };
  int n = 2;
  while (n < kMost && longer - shorter > kApart * kApart * shorter * spread(n)) ++n;
  // Either row of covariance − shorter I lies along the longer axis; the larger is taken.
  const Matrix2 rest = covariance - shorter * Matrix2::Identity();
  const Vector2 axis = rest(0, 0) > rest(1, 1) ? rest.row(0) : rest.row(1);
  shorter = std::max(shorter, longer / (1.0 + kApart * kApart * spread(kMost)));
  const Vector2 step = std::sqrt((longer - shorter) / spread(n)) * axis.normalized();
  float sum = 0.0F;
  for (int i = 1 - n; i < n; ++i) {
    sum += static_cast<float>(n - std::abs(i)) * texture_->sample(centre + i * step, shorter);
  }
  return sum / static_cast<float>(n * n);
}

float Renderer::intensity_at_edge(const View& view, const Ray& ray) const {
  constexpr double kFootprint = 0.3;  // of a ray, as a share of the blur
  const Matrix2 jacobian = ray.jacobian.cast<double>();
  float sum = 0.0F;
  for (const Vector2& offset : spread_) {
    const Vector3 cast = (ray.centre + jacobian * offset).homogeneous();
    const std::optional<Hit> hit = view.hit(cast);
    if (!hit) {
      sum += texture_->mean();
      continue;
    }
    const View::Place place = view.place(*hit, cast);
    const Matrix2 step = kFootprint * blur_ * (place.jacobian * jacobian);
    sum += texture_->sample(place.texture, std::max(step.col(0).squaredNorm(), step.col(1).squaredNorm()));
  }
  return sum / kEdgeRays;
}

}  // namespace evbench
