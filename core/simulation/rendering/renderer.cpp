#include "core/simulation/rendering/renderer.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "core/simulation/fast_math.hpp"
#include "core/support/index.hpp"
#include "core/support/parallel.hpp"

namespace evbench {
namespace {

/// Axes of a pixel's footprint whose squares differ by less than this are taken as equal.
constexpr float kRound = 1.5F;

/// The bits of the number mirrored at the binary point: van der Corput's sequence.
double van_der_corput(int i) {
  double value = 0.0;
  for (double digit = 0.5; i > 0; i /= 2, digit *= 0.5) value += digit * (i % 2);
  return value;
}

double normal_distribution(double x) { return 0.5 * std::erfc(-x * M_SQRT1_2); }

/// Inverse of the standard normal distribution, by bisection.
double normal_quantile(double p) {
  double low = -8.0, high = 8.0;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (normal_distribution(middle) < p ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

}  // namespace

Renderer::Renderer(const Camera& camera, const std::vector<Surface>& surfaces, const Texture& texture,
                   const Optics& optics, const Light& light)
    : camera_(camera), surfaces_(&surfaces), texture_(&texture), blur_(optics.blur), light_(light) {
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x) add_ray(Vector2(x, y));
  }
  for (std::size_t i = 0; i < kEdgeRays; ++i) {  // Hammersley's points, spread as a Gaussian
    spread_[i] = blur_ * Vector2(normal_quantile((static_cast<double>(i) + 0.5) / kEdgeRays),
                                 normal_quantile(van_der_corput(static_cast<int>(i)) + 0.5 / kEdgeRays));
  }
  if (optics.vignetting == 0.0 || camera.width * camera.height == 1) return;
  const Vector2 middle(0.5 * (camera.width - 1), 0.5 * (camera.height - 1));
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x) {
      const double lost = optics.vignetting * (Vector2(x, y) - middle).squaredNorm() / middle.squaredNorm();
      vignetting_.push_back(static_cast<float>(std::log1p(-lost)));
    }
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
  frame.hits.assign(rays_.size(), {});
  frame.edge.assign(rays_.size(), 1);
  render_next(T_world_camera, threads, frame, frame);
}

void Renderer::render_next(const SE3& T_world_camera, int threads, const Frame& before, Frame& frame) const {
  frame.log_intensity.resize(rays_.size());
  frame.hits.resize(rays_.size());
  frame.edge.resize(rays_.size());
  const View seen = view(T_world_camera);
  const int height = camera_.height;
  const std::size_t width = index(camera_.width);
  std::vector<std::uint8_t> even(index(height));  // rows that see a single face
  parallel_for(threads, height, [&](int y) {
    search_row(seen, y, before, frame);
    const auto row = std::span(frame.hits).subspan(index(y) * width, width);
    even[index(y)] = std::ranges::all_of(row, [&](const Hit& hit) { return hit.same_face(row.front()); });
  });
  parallel_for(threads, height, [&](int y) {
    mark_edges(y, even, frame);
    shade_row(seen, y, frame);
  });
}

/// Faces that a row of pixels sees. What was at no edge still sees its face.
void Renderer::search_row(const View& view, int y, const Frame& before, Frame& frame) const {
  const std::size_t width = index(camera_.width), first = index(y) * width, end = first + width;
  constexpr std::size_t kTogether = 12;  // [px] apart, so that they pass by as many boxes as possible
  const bool outermost = y == 0 || y == camera_.height - 1;
  std::array<std::size_t, View::kTogether> pixels;
  std::array<Vector2, View::kTogether> rays;
  std::array<Hit, View::kTogether> hits;
  std::size_t count = 0;
  const auto search = [&] {
    view.hit(std::span(rays).first(count), std::span(hits).first(count));
    for (std::size_t k = 0; k < count; ++k) frame.hits[pixels[k]] = hits[k];
    count = 0;
  };
  for (std::size_t i = first; i < end; ++i) {
    if (!before.edge[i] && !outermost && i != first && i + 1 != end) {
      frame.hits[i] = before.hits[i];
      continue;
    }
    if (count == rays.size() || (count > 0 && i > pixels[0] + kTogether)) search();
    pixels[count] = i;
    rays[count++] = rays_[i];
  }
  if (count > 0) search();
}

void Renderer::shade_row(const View& view, int y, Frame& frame) const {
  const std::size_t width = index(camera_.width), first = index(y) * width, last = first + width;
  for (std::size_t i = first; i < last;) {
    if (frame.edge[i]) {
      const Neighbours around = neighbours(i);
      std::array<Hit, 9> hits;
      for (std::size_t k = 0; k < around.count; ++k) hits[k] = frame.hits[around.pixels[k]];
      frame.log_intensity[i] = edge(view, i, around, std::span(hits).first(around.count));
      ++i;
      continue;
    }
    std::size_t end = i + 1;
    while (end < last && !frame.edge[end] && frame.hits[end].same_face(frame.hits[i])) ++end;
    shade(view, frame.hits[i], i, end - i, &frame.log_intensity[i]);
    i = end;
  }
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

float Renderer::pixel(const View& view, std::size_t index, const Frame& before, const Frame& after) const {
  if (!before.edge[index] && !after.edge[index] && before.hits[index].same_face(after.hits[index])) {
    float log_intensity = 0.0F;
    shade(view, after.hits[index], index, 1, &log_intensity);
    return log_intensity;
  }
  const Neighbours around = neighbours(index);
  std::array<Hit, 9> hits;
  const auto seen = std::span(hits).first(around.count);
  view.hit(std::span(around.rays).first(around.count), seen);
  return edge(view, index, around, seen);
}

Renderer::Neighbours Renderer::neighbours(std::size_t index) const {
  const int width = camera_.width, height = camera_.height;
  const int x = static_cast<int>(index) % width, y = static_cast<int>(index) / width;
  Neighbours around;
  for (int v = std::max(y - 1, 0); v <= std::min(y + 1, height - 1); ++v) {
    for (int u = std::max(x - 1, 0); u <= std::min(x + 1, width - 1); ++u) {
      const std::size_t i = evbench::index(v) * evbench::index(width) + evbench::index(u);
      around.pixels[around.count] = i;
      around.rays[around.count++] = rays_[i];
    }
  }
  return around;
}

/// Log intensities of consecutive pixels that see this face alone.
void Renderer::shade(const View& view, const Hit& hit, std::size_t first, std::size_t count,
                     float* log_intensity) const {
  if (hit.surface < 0) {
    std::fill_n(log_intensity, count, fast_log(texture_->mean()));
    return;
  }
  const SE3& T = view.T_world_camera();
  const Vector3 gradient = T.q.conjugate() * light_.gradient;  // in the camera's frame
  const double light = light_.gradient.dot(T.p - light_.origin);
  constexpr std::size_t kTogether = 64;
  const View::Face face = view.face(hit);
  const auto blur = static_cast<float>(blur_);
  while (count > 0) {
    const std::size_t now = std::min(count, kTogether);
    std::array<double, kTogether> u, v;            // place on the texture
    std::array<float, kTogether> xx, xy, yy;       // covariance of the footprint there
    std::array<float, kTogether> longer, shorter;  // variances along its axes
    std::array<float, kTogether> lit;              // logarithm of the light
    for (std::size_t i = 0; i < now; ++i) {
      const double x = rays_[first + i].x(), y = rays_[first + i].y();
      const View::Face::Place place = face.at(x, y);
      u[i] = place.u;
      v[i] = place.v;
      lit[i] = static_cast<float>(std::clamp(
          light + place.depth * (gradient.x() * x + (gradient.y() * y + gradient.z())), -light_.limit, light_.limit));
      const auto ux = static_cast<float>(place.ux), uy = static_cast<float>(place.uy);
      const auto vx = static_cast<float>(place.vx), vy = static_cast<float>(place.vy);
      const float* const J = jacobians_[first + i].data();  // by columns
      const float a = blur * (ux * J[0] + uy * J[1]), b = blur * (ux * J[2] + uy * J[3]);
      const float c = blur * (vx * J[0] + vy * J[1]), d = blur * (vx * J[2] + vy * J[3]);
      xx[i] = a * a + b * b;
      xy[i] = a * c + b * d;
      yy[i] = c * c + d * d;
      const float mean = 0.5F * (xx[i] + yy[i]), half = 0.5F * (xx[i] - yy[i]);
      const float difference = std::sqrt(half * half + xy[i] * xy[i]);
      longer[i] = mean + difference;
      shorter[i] = std::max(mean - difference, 1e-3F * longer[i]);
    }
    bool round = true;
    for (std::size_t i = 0; i < now; ++i) round &= longer[i] < kRound * shorter[i];
    if (round) {
      for (std::size_t i = 0; i < now; ++i) longer[i] = 0.5F * (xx[i] + yy[i]);
      texture_->sample(std::span(u).first(now), std::span(v).first(now), std::span(longer).first(now),
                       {log_intensity, now});
    } else {
      for (std::size_t i = 0; i < now; ++i) {
        log_intensity[i] = longer[i] < kRound * shorter[i]
                               ? texture_->sample(u[i], v[i], 0.5F * (xx[i] + yy[i]))
                               // A long footprint is a row of round ones.
                               : row_of_samples({u[i], v[i]}, xx[i], xy[i], yy[i], longer[i], shorter[i]);
      }
    }
    for (std::size_t i = 0; i < now; ++i) log_intensity[i] = lit[i] + fast_log(log_intensity[i]);
    if (!vignetting_.empty()) {
      for (std::size_t i = 0; i < now; ++i) log_intensity[i] += vignetting_[first + i];
    }
    first += now;
    log_intensity += now;
    count -= now;
  }
}

/// Round samples along the longer axis of a footprint, `longer` and `shorter` the variances along its axes. With
/// weights 1, 2, ..., n, ..., 2, 1 and the distance d between them their places have the variance d² (n² − 1) / 6.
float Renderer::row_of_samples(const Vector2& centre, float xx, float xy, float yy, float longer, float shorter) const {
  constexpr int kMost = 6;
  constexpr float kApart = 1.9F;  // so many standard deviations of one at most
  const auto spread = [](int n) { return static_cast<float>(n * n - 1) / 6.0F; };
  int n = 2;
  while (n < kMost && longer - shorter > kApart * kApart * shorter * spread(n)) ++n;
  // Either row of covariance − shorter I lies along the longer axis; the larger is taken.
  Eigen::Vector2f axis = xx > yy ? Eigen::Vector2f(xx - shorter, xy) : Eigen::Vector2f(xy, yy - shorter);
  shorter = std::max(shorter, longer / (1.0F + kApart * kApart * spread(kMost)));
  axis *= std::sqrt((longer - shorter) / (spread(n) * axis.squaredNorm()));
  std::array<double, 2 * kMost> x, y;
  std::array<float, 2 * kMost> variances, values;
  const std::size_t count = index(2 * n - 1);
  for (int i = 1 - n; i < n; ++i) {
    const auto share = static_cast<float>(i);
    const std::size_t k = index(i + n - 1);
    x[k] = centre.x() + share * axis.x();
    y[k] = centre.y() + share * axis.y();
    variances[k] = shorter;
  }
  texture_->sample(std::span(x).first(count), std::span(y).first(count), std::span(variances).first(count),
                   std::span(values).first(count));
  float sum = 0.0F;
  for (int i = 1 - n; i < n; ++i) sum += static_cast<float>(n - std::abs(i)) * values[index(i + n - 1)];
  return sum / static_cast<float>(n * n);
}

/// Log intensity of a pixel around which several faces may be seen, by the hits of its neighbours.
float Renderer::edge(const View& view, std::size_t index, const Neighbours& around, std::span<const Hit> hits) const {
  const Hit& a = hits.front();
  const auto other = std::ranges::find_if(hits, [&](const Hit& hit) { return !hit.same_face(a); });
  if (other == hits.end()) {
    float at_a = 0.0F;
    shade(view, a, index, 1, &at_a);
    return at_a;
  }
  const Hit& b = *other;
  const auto is_of_neither = [&](const Hit& hit) { return !hit.same_face(a) && !hit.same_face(b); };
  if (a.surface < 0 || b.surface < 0 || std::any_of(other, hits.end(), is_of_neither)) return corner(view, index);
  const std::optional<Vector3> line = view.border(a, b, std::span(around.rays).first(around.count), hits);
  if (!line) return corner(view, index);
  float at_a = 0.0F, at_b = 0.0F;
  shade(view, a, index, 1, &at_a);
  shade(view, b, index, 1, &at_b);
  // The Gaussian is cut at one pixel, from where on the neighbours see one face.
  const Vector2 slope = jacobians_[index].cast<double>().transpose() * line->head<2>();
  const double distance = line->dot(rays_[index].homogeneous()) / slope.norm();  // [px]
  const double cut = normal_distribution(-1.0 / blur_);
  const double share = (normal_distribution(distance / blur_) - cut) / (1.0 - 2.0 * cut);
  const auto of_a = static_cast<float>(std::clamp(share, 0.0, 1.0));
  return fast_log(of_a * std::exp(at_a) + (1.0F - of_a) * std::exp(at_b));
}

/// Log intensity of a pixel at which more than two faces are seen, or two that no line parts: each face's counts by its
/// share of rays.
float Renderer::corner(const View& view, std::size_t index) const {
  const Matrix2 jacobian = jacobians_[index].cast<double>();
  std::array<Vector2, kEdgeRays> rays;
  std::ranges::transform(spread_, rays.begin(),
                         [&](const Vector2& offset) -> Vector2 { return rays_[index] + jacobian * offset; });
  std::array<Hit, kEdgeRays> hits;
  view.hit(rays, hits);
  float sum = 0.0F;
  for (std::span<Hit> rest(hits); !rest.empty();) {
    const Hit hit = rest.front();
    const auto others = std::partition(rest.begin(), rest.end(), [&](const Hit& h) { return h.same_face(hit); });
    float log_intensity = 0.0F;
    shade(view, hit, index, 1, &log_intensity);
    sum += static_cast<float>(others - rest.begin()) * std::exp(log_intensity);
    rest = std::span<Hit>(others, rest.end());
  }
  return fast_log(sum / kEdgeRays);
}

}  // namespace evbench
