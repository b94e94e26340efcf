#include "core/simulation/rendering/view.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

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

View::View(const std::vector<Surface>& surfaces, const SE3& T_world_camera) : T_world_camera_(T_world_camera) {
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
  std::ranges::fill(hits, Hit{});
  for (std::size_t s = 0; s < seen_.size(); ++s) {
    if (seen_[s].surface->kind != Surface::Kind::box || may_reach(seen_[s], beam)) hit_surface(s, bundle, hits);
  }
}

/// Where the surface is nearer than what the rays hit so far.
void View::hit_surface(std::size_t surface, const Bundle& bundle, std::span<Hit> hits) const {
  Meeting meeting;
  const Seen& seen = seen_[surface];
  switch (seen.surface->kind) {
    case Surface::Kind::plane: meet_plane(seen, bundle, hits.size(), meeting); break;
    case Surface::Kind::room: meet_box<true>(seen, bundle, hits.size(), meeting); break;
    case Surface::Kind::box: meet_box<false>(seen, bundle, hits.size(), meeting); break;
  }
  for (std::size_t i = 0; i < hits.size(); ++i) {
    if (!(meeting.depth[i] < (hits[i].surface < 0 ? kInfinity : hits[i].depth))) continue;
    hits[i] = {static_cast<int>(surface), static_cast<int>(meeting.face[i]), meeting.depth[i]};
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

View::Face View::face(const Hit& hit) const {
  const Seen& seen = seen_[index(hit.surface)];
  const Eigen::Index axis = hit.face / 2, right = (axis + 1) % 3, down = (axis + 2) % 3;
  return {seen.R.row(axis),
          (hit.face % 2 == 1 ? seen.high : seen.low)[axis],
          {seen.R.row(right), seen.R.row(down)},
          seen.surface->offsets[index(hit.face)] + Vector2(seen.eye[right], seen.eye[down])};
}

std::optional<Vector3> View::border(const Hit& a, const Hit& b, std::span<const Vector2> rays,
                                    std::span<const Hit> hits) const {
  // Two planes meet in the image where their depths, distance / (normal · ray), are equal.
  const auto meet = [](const Face& p, const Face& q) -> Vector3 {
    return p.distance * q.normal - q.distance * p.normal;
  };
  // The line itself where it separates the rays.
  const auto separates = [&](const Vector3& line) -> std::optional<Vector3> {
    int sign = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const double side = line.dot(rays[i].homogeneous());
      const int wanted = (side > 0.0) == hits[i].same_face(a) ? 1 : -1;
      if (sign == 0) sign = wanted;
      if (sign != wanted) return std::nullopt;
    }
    return sign * line;
  };
  const auto crossing = [&] { return separates(meet(face(a), face(b))); };
  const auto outline = [&](const Hit& hit) -> std::optional<Vector3> {
    if (seen_[index(hit.surface)].surface->kind == Surface::Kind::plane) return std::nullopt;  // without end
    for (int other = 0; other < 6; ++other) {
      if (other / 2 == hit.face / 2) continue;
      if (const auto line = separates(meet(face(hit), face({hit.surface, other, 0.0})))) return line;
    }
    return std::nullopt;
  };
  if (a.surface == b.surface) return crossing();
  const auto& [near, far] = a.depth < b.depth ? std::tie(a, b) : std::tie(b, a);
  if (const auto line = outline(near)) return line;
  if (const auto line = crossing()) return line;
  return outline(far);
}

}  // namespace evbench
