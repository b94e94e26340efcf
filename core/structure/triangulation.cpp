#include "core/structure/triangulation.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "core/geometry/solve_symmetric.hpp"

namespace evbench {
namespace {

double angle(const Vector3& a, const Vector3& b) { return std::atan2(a.cross(b).norm(), a.dot(b)); }

/// Observations of one point from several cameras.
struct Views {
  std::vector<SE3> T_camera_world;
  std::span<const Vector2> pixels;
  const PinholeCamera& camera;

  /// Σ ‖reprojection error‖²; infinite if the point is not in front of every camera.
  double cost(const Vector3& point) const {
    double sum = 0.0;
    for (std::size_t i = 0; i < pixels.size(); ++i) {
      const Vector3 local = T_camera_world[i] * point;
      if (!(local.z() > 0.0)) return std::numeric_limits<double>::infinity();
      sum += (camera.project(local) - pixels[i]).squaredNorm();
    }
    return sum;
  }

  double min_depth(const Vector3& point) const {
    double depth = std::numeric_limits<double>::infinity();
    for (const SE3& T : T_camera_world) depth = std::min(depth, (T * point).z());
    return depth;
  }
};

Vector3 refine(const Views& views, Vector3 point, int iterations) {
  double cost = views.cost(point), damping = 1e-6;
  for (int iteration = 0; iteration < iterations; ++iteration) {
    Matrix3 H = Matrix3::Zero();
    Vector3 g = Vector3::Zero();
    for (std::size_t i = 0; i < views.pixels.size(); ++i) {
      const Vector3 local = views.T_camera_world[i] * point;
      const Matrix23 J = views.camera.project_jacobian(local) * views.T_camera_world[i].R();
      H += J.transpose() * J;
      g += J.transpose() * (views.camera.project(local) - views.pixels[i]);
    }
    H.diagonal() *= 1.0 + damping;
    const Vector3 step = solve_symmetric(H, -g);
    if (!step.allFinite()) break;
    const double next = views.cost(point + step);
    if (!(next <= cost)) {
      damping = std::max(10.0 * damping, 1e-4);
      continue;
    }
    const bool converged = cost - next <= 1e-9 * cost;
    point += step;
    cost = next;
    damping *= 0.1;
    if (converged) break;
  }
  return point;
}

/// The largest angle between two rays, by two sweeps: from the first ray, then from the ray farthest from it.
double largest_angle(const std::vector<Vector3>& rays) {
  std::size_t farthest = 0;
  double largest = 0.0;
  for (int sweep = 0; sweep < 2; ++sweep) {
    const Vector3 from = rays[farthest];
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const double a = angle(from, rays[i]);
      if (a > largest) {
        largest = a;
        farthest = i;
      }
    }
  }
  return largest;
}

}  // namespace

void TriangulationOptions::declare(OptionSet& set) {
  set.add("min_parallax_deg", min_parallax_deg, "minimum of the largest angle between two rays to a landmark [deg]")
      .range(0.0, 90.0);
  set.add("max_rms_px", max_rms_px, "maximum root mean square reprojection error of a landmark [px]").above(0.0);
  set.add("iterations", iterations, "maximum number of Levenberg-Marquardt iterations").range(0, 100);
}

std::string to_string(Triangulation::State state) {
  switch (state) {
    case Triangulation::State::ok: return "ok";
    case Triangulation::State::too_few_views: return "fewer than two views";
    case Triangulation::State::not_finite: return "not finite";
    case Triangulation::State::low_parallax: return "low parallax";
    case Triangulation::State::behind_camera: return "behind a camera";
    case Triangulation::State::large_error: return "large reprojection error";
  }
  return "unknown";
}

Triangulation triangulate(std::span<const SE3> T_world_camera, std::span<const Vector2> pixels,
                          const PinholeCamera& camera, const TriangulationOptions& options) {
  using State = Triangulation::State;
  Triangulation result;
  if (pixels.size() < 2) return result;

  // The point nearest to all rays: Σ (I − d dᵀ)(x − c) = 0.
  Views views{{}, pixels, camera};
  std::vector<Vector3> rays;
  Matrix3 A = Matrix3::Zero();
  Vector3 b = Vector3::Zero();
  bool finite = true;
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    const SE3& T = T_world_camera[i];
    finite = finite && pixels[i].allFinite() && T.p.allFinite() && T.q.coeffs().allFinite();
    rays.push_back((T.q * camera.ray(pixels[i])).normalized());
    views.T_camera_world.push_back(T.inverse());
    const Matrix3 across = Matrix3::Identity() - rays.back() * rays.back().transpose();
    A += across;
    b += across * T.p;
  }
  result.state = State::not_finite;
  if (!finite) return result;

  result.parallax_deg = largest_angle(rays) * kDegrees;
  if (result.parallax_deg < options.min_parallax_deg) {
    result.state = State::low_parallax;
    return result;
  }
  const Vector3 nearest = solve_symmetric(A, b);
  if (!nearest.allFinite()) return result;

  const bool in_front = views.min_depth(nearest) > 0.0;
  result.point = in_front ? refine(views, nearest, options.iterations) : nearest;
  result.min_depth = views.min_depth(result.point);
  const double cost = views.cost(result.point);
  if (!in_front || !std::isfinite(cost)) {
    result.state = State::behind_camera;
    return result;
  }
  result.rms_px = std::sqrt(cost / static_cast<double>(pixels.size()));
  result.state = result.rms_px <= options.max_rms_px ? State::ok : State::large_error;
  return result;
}

}  // namespace evbench
