#include "frontends/haste/displacement.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/geometry/seen_point.hpp"
#include "core/geometry/solve_symmetric.hpp"
#include "core/support/median.hpp"
#include "frontends/haste/tracking/alignment.hpp"

namespace evbench::haste {
namespace {

/// The landmarks whose displacements agree with one camera motion. It begins as the smallest motion that explains the
/// first landmark, then is refitted to all that agree. Indices in ascending order.
std::vector<std::size_t> agreeing_with(std::size_t first, std::span<const Displaced> seen,
                                       std::span<const Matrix26> by_motion) {
  constexpr double kUsual = 0.15;  // [rad, median depths]
  constexpr double kSigma = 2.0;   // [px]
  std::vector<std::size_t> agreeing{first};
  for (const double near : {10.0, 6.0, 3.0, 3.0}) {  // [px]
    Matrix6 H = std::pow(kSigma / kUsual, 2) * Matrix6::Identity();
    Vector6 b = Vector6::Zero();
    for (const std::size_t i : agreeing) {
      H += by_motion[i].transpose() * by_motion[i];
      b += by_motion[i].transpose() * seen[i].displacement;
    }
    const Vector6 motion = solve_symmetric(H, b);
    agreeing.clear();
    for (std::size_t i = 0; i < seen.size(); ++i) {
      if ((seen[i].displacement - by_motion[i] * motion).norm() < near) agreeing.push_back(i);
    }
  }
  return agreeing;
}

}  // namespace

std::optional<Vector2> most_like(const Template& look, std::span<const Event> events, const Vector2& about, int reach,
                                 double similarity) {
  constexpr int kStep = 2;  // [px] between positions in the first pass
  const Pixel place{static_cast<int>(std::lround(about.x())), static_cast<int>(std::lround(about.y()))};
  std::vector<Alignment> places = align_around(look, events, place, reach, kStep);
  std::erase_if(places, [](const Alignment& seen) { return seen.event_count < kWindowSize; });
  const auto best = std::ranges::max_element(places, {}, &Alignment::score);
  if (best == places.end() || best->score < similarity) return std::nullopt;
  const std::vector<Alignment> between = align_around(look, events, {best->x, best->y}, kStep - 1);
  const auto exact = std::ranges::max_element(between, {}, &Alignment::score);
  return Vector2(exact->x, exact->y);
}

std::vector<Displaced> displaced_together(std::span<const Displaced> seen, const PinholeCamera& camera, double beyond) {
  constexpr std::size_t kEnough = 6;
  constexpr std::size_t kShare = 2;  // one in so many of all, at least
  if (seen.size() < kEnough) return {};
  std::vector<double> depths;
  for (const Displaced& one : seen) depths.push_back(one.point.z());
  const double unit = median(std::move(depths));  // unit of length
  std::vector<Matrix26> by_motion;
  for (const Displaced& one : seen) {
    const Vector3 point = one.point / unit;
    by_motion.push_back(camera.project_jacobian(point) * seen_point_jacobian(point));
  }
  const auto is_aside = [&](std::size_t i) { return seen[i].displacement.norm() > beyond; };
  std::vector<std::size_t> most;
  for (std::size_t i = 0; i < seen.size(); ++i) {
    if (!is_aside(i)) continue;
    std::vector<std::size_t> agreeing = agreeing_with(i, seen, by_motion);
    if (agreeing.size() > most.size() && std::ranges::any_of(agreeing, is_aside)) most = std::move(agreeing);
  }
  if (most.size() < kEnough || kShare * most.size() < seen.size()) return {};
  std::vector<Displaced> result;
  for (const std::size_t i : most) result.push_back(seen[i]);
  return result;
}

}  // namespace evbench::haste
