#include "core/structure/map_alignment.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <unordered_map>
#include <vector>

#include "core/geometry/in_view.hpp"
#include "core/geometry/so3.hpp"
#include "core/geometry/solve_symmetric.hpp"
#include "core/support/index.hpp"

namespace evbench {
namespace {

using Matrix7 = Eigen::Matrix<double, 7, 7>;
using Vector7 = Eigen::Matrix<double, 7, 1>;

constexpr std::size_t kEnough = 8;           ///< landmarks
constexpr std::size_t kLeastPart = 3;        ///< at least one in this many common landmarks must agree
constexpr double kScaleSigma = 0.03;         ///< of the transform, relative, at most
constexpr double kLeastError = 0.5;          ///< [px], of a landmark in the images, at least
constexpr double kSameDepth = 1.3;           ///< maximum ratio of depths
constexpr double kRough = 6.0, kFine = 3.0;  ///< [px] maximum error, of a sample's alignment and of the refined one

/// A landmark of both maps.
struct Pair {
  Vector3 here, there;
  std::vector<const SE3*> views;  ///< that have it in view
};

std::vector<Pair> pairs_of(std::span<const Landmark> map, std::span<const SE3> views, std::span<const Landmark> other,
                           const PinholeCamera& camera) {
  std::unordered_map<TrackId, Vector3> there;
  for (const Landmark& landmark : other) there.emplace(landmark.track, landmark.position);
  std::vector<Pair> pairs;
  for (const Landmark& landmark : map) {
    const auto known = there.find(landmark.track);
    if (known == there.end()) continue;
    Pair pair{landmark.position, known->second, {}};
    for (const SE3& T : views) {
      const Vector3 seen = T.inverse() * pair.here;
      if (!(seen.z() > 0.0)) continue;
      if (in_view(camera, camera.project(seen), 1.0)) pair.views.push_back(&T);
    }
    if (!pair.views.empty()) pairs.push_back(std::move(pair));
  }
  return pairs;
}

/// Does the pair agree in this view?
bool agrees(const Pair& pair, const SE3& view, const Similarity& X, const PinholeCamera& camera, double px) {
  const SE3 T = view.inverse();
  const Vector3 here = T * pair.here, there = T * (X * pair.there);
  if (!(there.z() * kSameDepth > here.z() && here.z() * kSameDepth > there.z())) return false;
  return (camera.project(there) - camera.project(here)).norm() < px;
}

/// Does the pair agree roughly in its middle view?
bool agrees_roughly(const Pair& pair, const Similarity& X, const PinholeCamera& camera) {
  return agrees(pair, *pair.views[pair.views.size() / 2], X, camera, kRough);
}

/// Does the pair agree in most of its views?
bool agrees_finely(const Pair& pair, const Similarity& X, const PinholeCamera& camera) {
  const auto count = static_cast<std::size_t>(
      std::ranges::count_if(pair.views, [&](const SE3* view) { return agrees(pair, *view, X, camera, kFine); }));
  return 2 * count > pair.views.size();
}

template <class Agrees>
std::vector<const Pair*> agreeing(std::span<const Pair> pairs, const Similarity& X, const PinholeCamera& camera,
                                  const Agrees& agrees) {
  std::vector<const Pair*> result;
  for (const Pair& pair : pairs) {
    if (agrees(pair, X, camera)) result.push_back(&pair);
  }
  return result;
}

/// The similarity through three pairs. Collinear ones leave a rotation free; then few other pairs agree.
std::optional<Similarity> through(const std::array<const Pair*, 3>& sample) {
  Matrix3 here, there;
  for (int i = 0; i < 3; ++i) {
    here.col(i) = sample[index(i)]->here;
    there.col(i) = sample[index(i)]->there;
  }
  const Eigen::Matrix4d M = Eigen::umeyama(there, here, true);
  const double scale = std::cbrt(M.topLeftCorner<3, 3>().determinant());
  if (!M.allFinite() || !(scale > 0.0)) return std::nullopt;
  const Matrix3 R = M.topLeftCorner<3, 3>() / scale;
  return Similarity{scale, {Eigen::Quaterniond(R).normalized(), M.topRightCorner<3, 1>()}};
}

/// RANSAC: the similarity of the sample with which most pairs agree.
std::optional<Similarity> by_samples(std::span<const Pair> pairs, const PinholeCamera& camera) {
  constexpr int kSamples = 400;
  std::mt19937 random(1);  // deterministic
  const auto draw = [&] { return &pairs[random() % pairs.size()]; };
  std::optional<Similarity> best;
  std::size_t most = kEnough - 1;
  for (int i = 0; i < kSamples; ++i) {
    const std::array<const Pair*, 3> sample = {draw(), draw(), draw()};
    if (sample[0] == sample[1] || sample[0] == sample[2] || sample[1] == sample[2]) continue;
    const auto X = through(sample);
    if (!X) continue;
    if (const std::size_t count = agreeing(pairs, *X, camera, agrees_roughly).size(); count > most) {
      most = count;
      best = X;
    }
  }
  return best;
}

/// Normal equations of (rotation, translation, log scale), X ← Exp(δ) X, of the image distances; each pair counts as
/// one observation.
struct NormalEquations {
  Matrix7 H = Matrix7::Zero();
  Vector7 g = Vector7::Zero();
  double sum = 0.0;  ///< of squares, weighted [px²]
};

NormalEquations linearise(const std::vector<const Pair*>& pairs, const Similarity& X, const PinholeCamera& camera) {
  constexpr double kWidth = 1.0;  // [px] where the Cauchy loss turns from quadratic
  NormalEquations result;
  for (const Pair* pair : pairs) {
    const Vector3 point = X * pair->there;
    Eigen::Matrix<double, 3, 7> J_point;
    J_point << -so3::hat(point), Matrix3::Identity(), point;
    for (const SE3* view : pair->views) {
      const SE3 T = view->inverse();
      const Vector3 seen = T * point;
      if (!(seen.z() > 0.0)) continue;
      const Vector2 e = camera.project(seen) - camera.project(T * pair->here);
      const Eigen::Matrix<double, 2, 7> J = camera.project_jacobian(seen) * T.R() * J_point;
      const double weight = 1.0 / (1.0 + e.squaredNorm() / (kWidth * kWidth)) / static_cast<double>(pair->views.size());
      result.H += weight * J.transpose() * J;
      result.g += weight * J.transpose() * e;
      result.sum += weight * e.squaredNorm();
    }
  }
  return result;
}

}  // namespace

std::optional<MapAlignment> align_maps(std::span<const Landmark> map, std::span<const SE3> views,
                                       std::span<const Landmark> other, const PinholeCamera& camera) {
  constexpr int kIterations = 10;
  const std::vector<Pair> pairs = pairs_of(map, views, other, camera);
  if (pairs.size() < kEnough) return std::nullopt;
  const auto sampled = by_samples(pairs, camera);
  if (!sampled) return std::nullopt;
  Similarity X = *sampled;
  std::vector<const Pair*> agree = agreeing(pairs, X, camera, agrees_roughly);
  NormalEquations equations;
  for (int i = 0; i < kIterations; ++i) {
    equations = linearise(agree, X, camera);
    const Vector7 step = solve_symmetric(equations.H, -equations.g);
    if (!step.allFinite()) return std::nullopt;
    const double scale = std::exp(step[6]);
    X = Similarity{scale, {so3::exp(step.head<3>()), step.segment<3>(3)}} * X;
    agree = agreeing(pairs, X, camera, agrees_finely);
    if (agree.size() < kEnough || agree.size() * kLeastPart < pairs.size()) return std::nullopt;
  }
  equations = linearise(agree, X, camera);
  const double variance = std::max(kLeastError * kLeastError, equations.sum / static_cast<double>(agree.size()));
  const Vector7 scale = solve_symmetric(equations.H, Vector7::Unit(6));
  if (!(scale[6] > 0.0 && std::sqrt(variance * scale[6]) < kScaleSigma)) return std::nullopt;
  return MapAlignment{X, static_cast<int>(agree.size())};
}

}  // namespace evbench
