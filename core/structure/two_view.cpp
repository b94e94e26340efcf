#include "core/structure/two_view.hpp"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <opencv2/calib3d.hpp>

#include "core/geometry/nearest_rotation.hpp"
#include "core/geometry/so3.hpp"
#include "core/structure/epipolar_refinement.hpp"
#include "core/structure/triangulation.hpp"
#include "core/support/median.hpp"

namespace evbench {
namespace {

constexpr std::size_t kFewestMatches = 8;

struct Matches {
  std::span<const Vector2> first, second;
  const PinholeCamera& camera;
  const TwoViewOptions& options;

  std::size_t size() const { return first.size(); }
};

std::vector<cv::Point2d> to_cv(std::span<const Vector2> pixels) {
  std::vector<cv::Point2d> result;
  for (const Vector2& pixel : pixels) result.emplace_back(pixel.x(), pixel.y());
  return result;
}

/// OpenCV's (R, t) takes points of the first camera into the second.
SE3 from_cv(const cv::Mat& R, const cv::Mat& t) {
  Matrix3 rotation;
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) rotation(r, c) = R.at<double>(r, c);
  }
  SE3 T_second_first{Eigen::Quaterniond(rotation).normalized(), {t.at<double>(0), t.at<double>(1), t.at<double>(2)}};
  SE3 result = T_second_first.inverse();
  const double length = result.p.norm();
  if (length > 0.0) result.p /= length;
  return result;
}

struct Hypothesis {
  TwoViewCandidate::Model model;
  SE3 T_first_second;
};

/// All relative poses that the two models give, without any test.
std::vector<Hypothesis> hypotheses(const Matches& matches) {
  const PinholeCamera& camera = matches.camera;
  const cv::Matx33d K(camera.fx, 0.0, camera.cx, 0.0, camera.fy, camera.cy, 0.0, 0.0, 1.0);
  const std::vector<cv::Point2d> first = to_cv(matches.first), second = to_cv(matches.second);
  std::vector<Hypothesis> result;

  const cv::Mat essentials = cv::findEssentialMat(first, second, K, cv::RANSAC, matches.options.confidence,
                                                  matches.options.threshold_px, matches.options.max_iterations);
  for (int row = 0; row + 3 <= essentials.rows; row += 3) {
    cv::Mat R1, R2, t;
    cv::decomposeEssentialMat(essentials.rowRange(row, row + 3), R1, R2, t);
    for (const cv::Mat& R : {R1, R2}) {
      result.push_back({TwoViewCandidate::Model::five_point, from_cv(R, t)});
      result.push_back({TwoViewCandidate::Model::five_point, from_cv(R, -t)});
    }
  }
  const cv::Mat homography = cv::findHomography(first, second, cv::RANSAC, 2.0 * matches.options.threshold_px,
                                                cv::noArray(), 2000, matches.options.confidence);
  if (!homography.empty()) {
    std::vector<cv::Mat> rotations, translations, normals;
    cv::decomposeHomographyMat(homography, K, rotations, translations, normals);
    for (std::size_t i = 0; i < rotations.size(); ++i) {
      if (cv::norm(translations[i]) < 1e-9) continue;
      result.push_back({TwoViewCandidate::Model::homography, from_cv(rotations[i], translations[i])});
    }
  }
  return result;
}

/// Triangulates every match and counts the inliers.
TwoViewCandidate score_candidate(const Hypothesis& hypothesis, const Matches& matches) {
  TwoViewCandidate result;
  result.model = hypothesis.model;
  result.T_first_second = hypothesis.T_first_second;
  result.inlier.assign(matches.size(), false);
  result.points.assign(matches.size(), Vector3::Zero());
  const std::array<SE3, 2> poses{SE3{}, hypothesis.T_first_second};
  TriangulationOptions options;
  options.min_parallax_deg = 0.0;
  options.max_rms_px = matches.options.threshold_px;
  std::vector<double> parallaxes;
  double squares = 0.0;
  for (std::size_t i = 0; i < matches.size(); ++i) {
    const std::array<Vector2, 2> pixels{matches.first[i], matches.second[i]};
    const Triangulation point = triangulate(poses, pixels, matches.camera, options);
    if (!point.ok()) continue;
    result.inlier[i] = true;
    result.points[i] = point.point;
    ++result.inliers;
    squares += point.rms_px * point.rms_px;
    parallaxes.push_back(point.parallax_deg);
  }
  result.median_parallax_deg = parallaxes.empty() ? 0.0 : median(std::move(parallaxes));
  result.rms_px = result.inliers > 0 ? std::sqrt(squares / result.inliers) : 0.0;
  return result;
}

/// Refines a candidate on its inliers, twice because they change; keeps the previous one if it has more inliers.
TwoViewCandidate refined(TwoViewCandidate candidate, const Matches& matches) {
  for (int round = 0; round < 2; ++round) {
    const SE3 T = refine_relative_pose(candidate.T_first_second, matches.first, matches.second, candidate.inlier,
                                       matches.camera, 0.5 * matches.options.threshold_px);
    TwoViewCandidate next = score_candidate({candidate.model, T}, matches);
    if (next.inliers < candidate.inliers) break;
    candidate = std::move(next);
  }
  return candidate;
}

bool better(const TwoViewCandidate& a, const TwoViewCandidate& b) {
  return a.inliers != b.inliers ? a.inliers > b.inliers : a.rms_px < b.rms_px;
}

bool same_pose(const SE3& a, const SE3& b) {
  const double rotation = a.q.angularDistance(b.q) * kDegrees;
  const double direction = std::atan2(a.p.cross(b.p).norm(), a.p.dot(b.p)) * kDegrees;
  return rotation < 1.0 && direction < 5.0;
}

/// Number of matches that a rotation alone explains: Wahba's problem, iteratively reweighted.
int explained_by_rotation(const Matches& matches) {
  std::vector<double> weights(matches.size(), 1.0);
  const double limit = 2.0 * matches.options.threshold_px;
  int count = 0;
  for (int iteration = 0; iteration < 10; ++iteration) {
    Matrix3 B = Matrix3::Zero();
    for (std::size_t i = 0; i < matches.size(); ++i) {
      const Vector3 ray1 = matches.camera.ray(matches.first[i]), ray2 = matches.camera.ray(matches.second[i]);
      B += weights[i] * ray1.normalized() * ray2.normalized().transpose();
    }
    const Matrix3 R = nearest_rotation(B).R;
    count = 0;
    for (std::size_t i = 0; i < matches.size(); ++i) {
      const Vector3 ray = R * matches.camera.ray(matches.second[i]);
      const double distance = ray.z() > 0.0 ? (matches.camera.project(ray) - matches.first[i]).norm() : HUGE_VAL;
      weights[i] = 1.0 / std::max(distance, 0.1);
      if (distance < limit) ++count;
    }
  }
  return count;
}

/// The distinct candidates with about as many inliers as the best one, best first.
std::vector<TwoViewCandidate> distinct(const std::vector<TwoViewCandidate>& all, double ambiguity) {
  // Indices, not candidates, are sorted: libstdc++'s stable_sort misaligns the poses in its temporary buffer.
  std::vector<std::size_t> order(all.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return better(all[a], all[b]); });
  std::vector<TwoViewCandidate> result;
  for (const std::size_t i : order) {
    if (all[i].inliers < ambiguity * all[order.front()].inliers) break;
    const bool known = std::any_of(result.begin(), result.end(), [&](const TwoViewCandidate& other) {
      return same_pose(other.T_first_second, all[i].T_first_second);
    });
    if (!known) result.push_back(all[i]);
  }
  return result;
}

}  // namespace

void TwoViewOptions::declare(OptionSet& set) {
  set.add("threshold_px", threshold_px, "maximum distance of an inlier from the model [px]").above(0.0);
  set.add("confidence", confidence, "confidence of RANSAC").range(0.5, 0.999999);
  set.add("max_iterations", max_iterations, "maximum number of RANSAC samples of five matches").range(1);
  set.add("min_inliers", min_inliers, "minimum number of inlier matches of the relative pose").range(8);
  set.add("min_inlier_share", min_inlier_share, "the same as a fraction of all matches").range(0.0, 1.0);
  set.add("min_parallax_deg", min_parallax_deg,
          "minimum of the median parallax of the inliers [deg]; 0: none, and "
          "matches that a rotation explains are accepted")
      .range(0.0, 90.0);
  set.add("ambiguity", ambiguity, "a second solution is kept if it has this fraction of the best one's inliers")
      .range(0.0, 1.0);
}

TwoViewResult relative_pose(std::span<const Vector2> first, std::span<const Vector2> second,
                            const PinholeCamera& camera, const TwoViewOptions& options) {
  const Matches matches{first, second, camera, options};
  const auto finite = [](const Vector2& pixel) { return pixel.allFinite(); };
  if (!std::all_of(first.begin(), first.end(), finite) || !std::all_of(second.begin(), second.end(), finite)) {
    return {{}, "a matched pixel is not finite"};
  }
  if (first.size() < kFewestMatches || static_cast<int>(first.size()) < options.min_inliers) {
    return {{}, fmt::format("{} matches, {} needed", first.size(), std::max<int>(kFewestMatches, options.min_inliers))};
  }

  const int rotated = options.min_parallax_deg > 0.0 ? explained_by_rotation(matches) : 0;
  if (rotated >= 0.9 * static_cast<double>(first.size())) {
    return {{}, fmt::format("a rotation alone explains {} of {} matches", rotated, first.size())};
  }
  std::vector<TwoViewCandidate> all;
  try {
    for (const Hypothesis& hypothesis : hypotheses(matches)) {
      TwoViewCandidate candidate = score_candidate(hypothesis, matches);
      if (candidate.inliers >= static_cast<int>(kFewestMatches)) all.push_back(refined(std::move(candidate), matches));
    }
  } catch (const cv::Exception& e) {
    return {{}, fmt::format("the two-view solver failed: {}", e.err)};
  }
  all = distinct(all, options.ambiguity);

  const auto share = [&](double of) { return static_cast<int>(std::ceil(of * static_cast<double>(first.size()))); };
  const int needed = std::max(options.min_inliers, share(options.min_inlier_share));
  const int explained = all.empty() ? 0 : all.front().inliers;
  if (rotated >= needed && rotated >= 0.9 * explained) {
    return {{}, fmt::format("a rotation alone explains {} matches, the best relative pose {}", rotated, explained)};
  }
  if (explained < needed) {
    return {{}, fmt::format("{} of {} matches explained, {} needed", explained, first.size(), needed)};
  }
  // The best candidate must have the parallax: a worse one that has it only fits noise.
  if (all.front().median_parallax_deg < options.min_parallax_deg) {
    return {{},
            fmt::format("median parallax {:.2f} deg, {:.2f} needed", all.front().median_parallax_deg,
                        options.min_parallax_deg)};
  }
  std::erase_if(all, [&](const TwoViewCandidate& c) {
    return c.inliers < needed || c.median_parallax_deg < options.min_parallax_deg;
  });
  return {std::move(all), ""};
}

}  // namespace evbench
