#include "core/simulation/rendering/renderer.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/support/index.hpp"
#include "core/support/parallel.hpp"

namespace evbench {
namespace {

/// Axes of a pixel's footprint whose squares differ by less than this are taken as equal.
constexpr double kRound = 1.25;

/// The bits of the number mirrored at the binary point: van der Corput's sequence.
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
    for (int x = 0; x < camera.width; ++x) add_ray(Vector2(x, y));
  }
  for (std::size_t i = 0; i < kEdgeRays; ++i) {  // Hammersley's points, spread as a Gaussian
    spread_[i] = blur * Vector2(normal_quantile((static_cast<double>(i) + 0.5) / kEdgeRays),
                                normal_quantile(van_der_corput(static_cast<int>(i)) + 0.5 / kEdgeRays));
  }
}

void Renderer::add_ray(const Vector2& pixel) {
  constexpr double kH = 0.5;
  Vector2& ray = rays_.emplace_back(Vector2::Constant(std::numeric_limits<double>::quiet_NaN()));
  Eigen::Matrix2f& jacobian = jacobians_.emplace_back(Eigen::Matrix2f::Zero());
  const std::optional<Vector2> centre = camera_.undistort(pixel);
  if (!centre) return;
  for (Eigen::Index axis = 0; axis < 2; ++axis) {
    const Vector2 step = kH * Vector2::Unit(axis);
    const std::optional<Vector2> before = camera_.undistort(pixel - step), after = camera_.undistort(pixel + step);
    if (!before || !after) return;
    const Vector3 slope = (camera_.pinhole.ray(*after) - camera_.pinhole.ray(*before)) / (2.0 * kH);
    jacobian.col(axis) = slope.head<2>().cast<float>();
  }
  ray = camera_.pinhole.ray(*centre).head<2>();
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
    seen.hit(std::span(rays_).subspan(row(y), index(width)), std::span(frame.hits).subspan(row(y), index(width)));
    const auto begin = frame.hits.begin() + static_cast<std::ptrdiff_t>(row(y));
    even[index(y)] = std::all_of(begin, begin + width, [&](const Hit& h) { return h.same_face(*begin); });
  });
  parallel_for(threads, height, [&](int y) {
    mark_edges(y, even, frame);
    for (std::size_t i = row(y); i < row(y + 1); ++i) {
      frame.log_intensity[i] = log_of(frame.edge[i] ? intensity_at_edge(seen, i) : intensity(seen, frame.hits[i], i));
    }
  });
}

/// Marks the edges of a row by the rows above and below.
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
  return log_of(edge ? intensity_at_edge(view, index) : intensity(view, view.hit(rays_[index]), index));
}

float Renderer::intensity(const View& view, const Hit& hit, std::size_t index) const {
  if (hit.surface < 0) return texture_->mean();
  const View::Place place = view.place(hit, rays_[index]);
  const Matrix2 step = blur_ * (place.jacobian * jacobians_[index].cast<double>());
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

float Renderer::intensity_at_edge(const View& view, std::size_t index) const {
  constexpr double kFootprint = 0.3;  // of a ray, as a share of the blur
  const Matrix2 jacobian = jacobians_[index].cast<double>();
  std::array<Vector2, kEdgeRays> rays;
  std::ranges::transform(spread_, rays.begin(),
                         [&](const Vector2& offset) -> Vector2 { return rays_[index] + jacobian * offset; });
  std::array<Hit, kEdgeRays> hits;
  view.hit(rays, hits);
  float sum = 0.0F;
  for (std::size_t i = 0; i < kEdgeRays; ++i) {
    if (hits[i].surface < 0) {
      sum += texture_->mean();
      continue;
    }
    const View::Place place = view.place(hits[i], rays[i]);
    const Matrix2 step = kFootprint * blur_ * (place.jacobian * jacobian);
    sum += texture_->sample(place.texture, std::max(step.col(0).squaredNorm(), step.col(1).squaredNorm()));
  }
  return sum / kEdgeRays;
}

}  // namespace evbench
