#include "core/simulation/rendering/view.hpp"

#include <limits>

#include "core/support/index.hpp"

namespace evbench {
namespace {

constexpr double kNearest = 1e-6;  // [m]

}  // namespace

View::View(const std::vector<Surface>& surfaces, const SE3& T_world_camera) {
  const SE3 T_camera_world = T_world_camera.inverse();
  for (const Surface& surface : surfaces) {
    const SE3 T_camera_surface = T_camera_world * surface.T_world_surface;
    const Matrix3 R = T_camera_surface.R().transpose();
    const Vector3& centre = T_camera_surface.p;
    seen_.push_back({&surface, R, -(R * centre), centre, centre.squaredNorm() - surface.half.squaredNorm()});
  }
}

std::optional<Hit> View::hit(const Vector3& ray) const {
  std::optional<Hit> nearest;
  const double length_square = ray.squaredNorm();
  for (std::size_t i = 0; i < seen_.size(); ++i) {
    const Seen& seen = seen_[i];
    if (seen.surface->kind == Surface::Kind::box && seen.tangent_square > 0.0) {
      const double along = seen.centre.dot(ray);  // does the ray meet the sphere around the box?
      if (along < 0.0 || along * along < seen.tangent_square * length_square) continue;
    }
    std::optional<Hit> met = meet(seen, ray);
    if (!met || (nearest && nearest->depth <= met->depth)) continue;
    met->surface = static_cast<int>(i);
    nearest = met;
  }
  return nearest;
}

std::optional<Hit> View::meet(const Seen& seen, const Vector3& ray) {
  const Vector3 d = seen.R * ray;
  if (seen.surface->kind == Surface::Kind::plane) {
    const double depth = -seen.eye.z() / d.z();
    if (!(depth > kNearest && depth < std::numeric_limits<double>::infinity())) return std::nullopt;
    return Hit{-1, 4, depth};
  }
  // The ray is inside the box between the last of its entries into the slabs and the first of its exits.
  Hit entry{-1, 0, -std::numeric_limits<double>::infinity()}, exit{-1, 0, std::numeric_limits<double>::infinity()};
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    const int low = 2 * static_cast<int>(axis);
    const double half = seen.surface->half[axis], eye = seen.eye[axis], direction = d[axis];
    if (direction == 0.0) {
      if (std::abs(eye) > half) return std::nullopt;
      continue;
    }
    const double to_low = (-half - eye) / direction, to_high = (half - eye) / direction;
    const bool forward = direction > 0.0;
    const Hit in{-1, forward ? low : low + 1, forward ? to_low : to_high};
    const Hit out{-1, forward ? low + 1 : low, forward ? to_high : to_low};
    if (in.depth > entry.depth) entry = in;
    if (out.depth < exit.depth) exit = out;
  }
  const Hit& met = seen.surface->kind == Surface::Kind::room ? exit : entry;
  if (entry.depth > exit.depth || met.depth < kNearest) return std::nullopt;
  return met;
}

View::Place View::place(const Hit& hit, const Vector3& ray) const {
  const Seen& seen = seen_[index(hit.surface)];
  const Eigen::Index axis = hit.face / 2;
  const Vector3 d = seen.R * ray;
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
