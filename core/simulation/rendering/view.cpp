#include "core/simulation/rendering/view.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/support/index.hpp"

namespace evbench {
namespace {

constexpr double kNearest = 1e-6;  // [m]
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Component of a ray (x, y, 1) along an axis.
inline double along(const Matrix3& R, Eigen::Index axis, double x, double y) {
  return R(axis, 0) * x + (R(axis, 1) * y + R(axis, 2));
}

}  // namespace

View::View(const std::vector<Surface>& surfaces, const SE3& T_world_camera) {
  const SE3 T_camera_world = T_world_camera.inverse();
  for (const Surface& surface : surfaces) {
    const SE3 T_camera_surface = T_camera_world * surface.T_world_surface;
    const Matrix3 R = T_camera_surface.R().transpose();
    const Vector3 eye = -(R * T_camera_surface.p);
    const Vector3& centre = T_camera_surface.p;
    const double radius = surface.half.norm();
    seen_.push_back({&surface, R, eye, -surface.half - eye, surface.half - eye, centre, radius,
                     std::sqrt(std::max(0.0, centre.squaredNorm() - radius * radius))});
  }
}

void View::hit(std::span<const Vector2> rays, std::span<Hit> hits) const {
  for (std::size_t i = 0; i < rays.size(); i += kTogether) {
    const std::size_t count = std::min(kTogether, rays.size() - i);
    hit_together(rays.subspan(i, count), hits.subspan(i, count));
  }
}

Hit View::hit(const Vector2& ray) const {
  Hit hit;
  hit_together({&ray, 1}, {&hit, 1});
  return hit;
}

void View::hit_together(std::span<const Vector2> rays, std::span<Hit> hits) const {
  Bundle bundle;
  Vector2 least = Vector2::Constant(kInfinity), most = -least;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    bundle.x[i] = rays[i].x();
    bundle.y[i] = rays[i].y();
    for (Eigen::Index axis = 0; axis < 2; ++axis) {
      least[axis] = std::min(least[axis], rays[i][axis]);
      most[axis] = std::max(most[axis], rays[i][axis]);
    }
  }
  Beam beam{Vector2(0.5 * (least + most)).homogeneous(), 0.5 * (most - least).norm(), 0.0, 0.0};
  beam.length = beam.middle.norm();
  beam.cosine = std::sqrt(1.0 - beam.radius * beam.radius);
  std::array<double, kTogether> nearest;
  nearest.fill(kInfinity);
  std::ranges::fill(hits, Hit{});
  Meeting meeting;
  for (std::size_t s = 0; s < seen_.size(); ++s) {
    const Seen& seen = seen_[s];
    switch (seen.surface->kind) {
      case Surface::Kind::plane: meet_plane(seen, bundle, rays.size(), meeting); break;
      case Surface::Kind::room: meet_box<true>(seen, bundle, rays.size(), meeting); break;
      case Surface::Kind::box:
        if (!may_reach(seen, beam)) continue;
        meet_box<false>(seen, bundle, rays.size(), meeting);
        break;
    }
    for (std::size_t i = 0; i < rays.size(); ++i) {
      if (!(meeting.depth[i] < nearest[i])) continue;
      nearest[i] = meeting.depth[i];
      hits[i] = {static_cast<int>(s), static_cast<int>(meeting.face[i]), meeting.depth[i]};
    }
  }
}

/// Can a ray whose x and y are no farther from the middle one's than the beam's radius meet the sphere around the box,
/// and then the widest intervals of its slabs?
bool View::may_reach(const Seen& seen, const Beam& beam) {
  constexpr double kRounding = 1e-9;
  if (seen.tangent > 0.0) {
    // A ray is off the middle one by an angle whose sine is the radius at most; one that touches the sphere is off its
    // centre by an angle whose sine is the sphere's radius by the centre's distance.
    const double least = seen.tangent * beam.cosine - seen.radius * beam.radius;
    if (seen.centre.dot(beam.middle) < beam.length * least - kRounding) return false;
  }
  const Vector3 d = seen.R * beam.middle;
  double from = 0.0, to = kInfinity;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    const double least = d[axis] - beam.radius - kRounding, most = d[axis] + beam.radius + kRounding;
    if (least <= 0.0 && most >= 0.0) continue;
    const double low = seen.low[axis], high = seen.high[axis];
    const auto [nearest, farthest] = std::minmax({low / least, low / most, high / least, high / most});
    from = std::max(from, nearest);
    to = std::min(to, farthest);
  }
  return from <= to;
}

void View::meet_plane(const Seen& seen, const Bundle& rays, std::size_t count, Meeting& meeting) {
  for (std::size_t i = 0; i < count; ++i) {
    const double depth = -seen.eye.z() / along(seen.R, 2, rays.x[i], rays.y[i]);
    meeting.depth[i] = depth > kNearest ? depth : kInfinity;
    meeting.face[i] = 4.0;
  }
}

/// A ray is inside a box between the last of its entries into the slabs and the first of its exits. Along an axis that
/// it does not follow it is always inside, or never; one that lies in a face misses the box.
/// kInside: the box is seen from inside.
template <bool kInside>
void View::meet_box(const Seen& seen, const Bundle& rays, std::size_t count, Meeting& meeting) {
  for (std::size_t i = 0; i < count; ++i) {
    double entry = -kInfinity, exit = kInfinity, face = 0.0;
    for (int axis = 0; axis < 3; ++axis) {
      const double d = along(seen.R, axis, rays.x[i], rays.y[i]);
      const double to_low = seen.low[axis] / d, to_high = seen.high[axis] / d;
      const double in = to_low < to_high ? to_low : to_high, out = to_low < to_high ? to_high : to_low;
      const bool decides = kInside ? out < exit : in > entry;
      face = decides ? 2.0 * axis + ((d > 0.0) == kInside ? 1.0 : 0.0) : face;
      entry = in > entry ? in : entry;
      exit = out < exit ? out : exit;
    }
    const double depth = kInside ? exit : entry;
    meeting.depth[i] = entry <= exit && depth >= kNearest ? depth : kInfinity;
    meeting.face[i] = face;
  }
}

View::Place View::place(const Hit& hit, const Vector2& ray) const {
  const Seen& seen = seen_[index(hit.surface)];
  const Eigen::Index axis = hit.face / 2;
  const Vector3 d = seen.R * ray.homogeneous();
  Place place{seen.surface->offsets[index(hit.face)], {}};
  for (Eigen::Index i = 0; i < 2; ++i) {
    const Eigen::Index along = (axis + 1 + i) % 3;
    place.texture[i] += seen.eye[along] + hit.depth * d[along];
    // From eye + depth d being on the face: ∂depth = −depth ∂d[axis] / d[axis].
    const double slant = d[along] / d[axis];
    for (Eigen::Index j = 0; j < 2; ++j) {
      place.jacobian(i, j) = hit.depth * (seen.R(along, j) - slant * seen.R(axis, j));
    }
  }
  return place;
}

}  // namespace evbench
