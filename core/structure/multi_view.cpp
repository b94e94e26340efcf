#include "core/structure/multi_view.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>

#include "core/geometry/tangent_plane.hpp"
#include "core/structure/resection.hpp"
#include "core/support/index.hpp"
#include "core/support/median.hpp"

namespace evbench {
namespace {

using Matrix6x3 = Eigen::Matrix<double, 6, 3>;

constexpr double kBehind = 30.0;        ///< [px] error assigned to a point behind the camera
constexpr double kLeastInverse = 0.01;  ///< points are at most a hundred times the median distance away

/// Moves a point by a step in the tangent plane of its direction and in its inverse distance.
InversePoint moved(const InversePoint& point, const Vector3& step) {
  return {(point.direction + tangent_plane(point.direction) * step.head<2>()).normalized(), point.inverse + step.z()};
}

InversePoint to_inverse(const Vector3& position) {
  const double distance = position.norm();
  return {position / distance, 1.0 / distance};
}

void normalise(ViewsEstimate& estimate) {
  std::vector<double> inverse;
  for (const InversePoint& point : estimate.points) inverse.push_back(point.inverse);
  const double unit = median(std::move(inverse));
  if (!(unit > 0.0)) return;
  for (InversePoint& point : estimate.points) point.inverse /= unit;
  for (SE3& T : estimate.poses) T.p *= unit;
}

}  // namespace

TrackViews TrackViews::of(const TrackBuffer& tracks, std::vector<double> times, const PlaceWindow& window,
                          std::size_t most) {
  constexpr int kFewest = 3;
  struct Candidate {
    TrackId track;
    int seen;
    std::vector<std::optional<Vector2>> places;
  };
  std::vector<Candidate> candidates;
  for (const TrackId id : tracks.ids()) {
    Candidate candidate{id, 0, {}};
    for (const double t : times) {
      candidate.places.push_back(tracks.position(id, t, window));
      if (candidate.places.back()) ++candidate.seen;
    }
    if (candidate.seen >= kFewest) candidates.push_back(std::move(candidate));
  }
  std::ranges::stable_sort(candidates, std::greater<>(), &Candidate::seen);
  candidates.resize(std::min(candidates.size(), most));
  TrackViews result;
  result.times = std::move(times);
  std::vector<double> sigmas;
  for (Candidate& candidate : candidates) {
    sigmas.push_back(tracks.observations(candidate.track).front().noise.sigma());
    result.tracks.push_back(candidate.track);
    result.places.push_back(std::move(candidate.places));
  }
  if (!sigmas.empty()) result.sigma = median(std::move(sigmas));
  return result;
}

/// The normal equations at an estimate, of all points and all poses but the first.
class MultiView::Step {
 public:
  Step(const MultiView& problem, const ViewsEstimate& at) : views_(problem.views_.times.size()) {
    const BoundedLoss loss{at.width};
    cameras_.assign(views_, Matrix6::Zero());
    camera_gradients_.assign(views_, Vector6::Zero());
    for (std::size_t i = 0; i < at.points.size(); ++i) {
      Point point;
      const Eigen::Matrix<double, 3, 2> basis = tangent_plane(at.points[i].direction);
      for (std::size_t v = 0; v < views_; ++v) {
        const auto& place = problem.views_.places[i][v];
        if (!place) continue;
        const auto image = point_image(at.poses[v], at.points[i], *place, problem.camera_);
        if (!image) continue;
        const double squared = image->error.squaredNorm(), weight = loss.weight(squared);
        Matrix23 J;
        J << image->direction * basis, image->inverse;
        point.H += weight * J.transpose() * J;
        point.g += weight * J.transpose() * image->error;
        weights_ += weight;
        squares_ += weight * squared;
        if (v == 0) continue;
        cameras_[v] += weight * image->pose.transpose() * image->pose;
        camera_gradients_[v] += weight * image->pose.transpose() * image->error;
        point.couplings.push_back({v, weight * image->pose.transpose() * J});
      }
      points_.push_back(std::move(point));
    }
  }

  /// The step with a damped diagonal (relative to it). False if the system can't be solved.
  bool solve(double damping, std::vector<Vector6>& poses, std::vector<Vector3>& points) const {
    const Reduced reduced = reduce(damping);
    const Eigen::LDLT<Eigen::MatrixXd> factor(reduced.S);
    const Eigen::VectorXd step = factor.solve(-reduced.g);
    if (factor.info() != Eigen::Success || !step.allFinite()) return false;
    poses.assign(views_, Vector6::Zero());
    for (std::size_t v = 1; v < views_; ++v) poses[v] = step.segment<6>(row(v));
    points.clear();
    for (std::size_t i = 0; i < points_.size(); ++i) {
      Vector3 g = points_[i].g;
      for (const Coupling& c : points_[i].couplings) g += c.H.transpose() * poses[c.view];
      points.push_back(-(reduced.inverses[i] * g));
    }
    return true;
  }

  /// Standard deviation of the errors of one coordinate [px], corrected for the degrees of freedom of the unknowns.
  double noise() const {
    const double freedom =
        2.0 * weights_ - 6.0 * static_cast<double>(views_ - 1) - 3.0 * static_cast<double>(points_.size());
    return std::sqrt(squares_ / std::max(freedom, 1.0));
  }

  /// Standard deviation of each point's inverse distance for unit noise, with the distance of one camera (`held`) fixed
  /// along `direction`.
  std::vector<double> inverse_sigmas(std::size_t held, const Vector3& direction) const {
    Reduced reduced = reduce(0.0);
    constexpr double kTight = 1e6;
    Vector6 along = Vector6::Zero();
    along.tail<3>() = direction;
    const double stiffness = kTight * reduced.S.diagonal().segment<6>(row(held)).tail<3>().maxCoeff();
    reduced.S.block<6, 6>(row(held), row(held)) += stiffness * along * along.transpose();
    const Eigen::MatrixXd covariance =
        reduced.S.ldlt().solve(Eigen::MatrixXd::Identity(reduced.S.rows(), reduced.S.cols()));
    std::vector<double> result;
    for (std::size_t i = 0; i < points_.size(); ++i) {
      Eigen::VectorXd sensitivity = Eigen::VectorXd::Zero(covariance.rows());
      for (const Coupling& c : points_[i].couplings) {
        sensitivity.segment<6>(row(c.view)) = c.H * reduced.inverses[i].col(2);
      }
      result.push_back(std::sqrt(std::max(0.0, reduced.inverses[i](2, 2) + sensitivity.dot(covariance * sensitivity))));
    }
    return result;
  }

 private:
  struct Coupling {
    std::size_t view;
    Matrix6x3 H;
  };
  struct Point {
    Matrix3 H = Matrix3::Zero();
    Vector3 g = Vector3::Zero();
    std::vector<Coupling> couplings;
  };
  /// The reduced system after elimination of the points.
  struct Reduced {
    Eigen::MatrixXd S;
    Eigen::VectorXd g;
    std::vector<Matrix3> inverses;  ///< of the points' blocks
  };

  static Eigen::Index row(std::size_t view) { return 6 * static_cast<Eigen::Index>(view - 1); }

  Reduced reduce(double damping) const {
    constexpr double kLeastInformation = 1e-9;
    const auto size = 6 * static_cast<Eigen::Index>(views_ - 1);
    Reduced result{Eigen::MatrixXd::Zero(size, size), Eigen::VectorXd::Zero(size), {}};
    for (std::size_t v = 1; v < views_; ++v) {
      Matrix6 H = cameras_[v];
      H.diagonal() += damping * H.diagonal() + Vector6::Constant(kLeastInformation);
      result.S.block<6, 6>(row(v), row(v)) = H;
      result.g.segment<6>(row(v)) = camera_gradients_[v];
    }
    for (const Point& point : points_) {
      Matrix3 H = point.H;
      H.diagonal() += damping * H.diagonal() + Vector3::Constant(kLeastInformation);
      result.inverses.push_back(H.inverse());
      for (const Coupling& a : point.couplings) {
        const Matrix6x3 Y = a.H * result.inverses.back();
        result.g.segment<6>(row(a.view)) -= Y * point.g;
        for (const Coupling& b : point.couplings) {
          if (b.view > a.view) break;  // the lower triangle
          result.S.block<6, 6>(row(a.view), row(b.view)) -= Y * b.H.transpose();
        }
      }
    }
    result.S.triangularView<Eigen::StrictlyUpper>() = result.S.transpose();
    return result;
  }

  std::size_t views_;
  std::vector<Matrix6> cameras_;
  std::vector<Vector6> camera_gradients_;
  std::vector<Point> points_;
  double weights_ = 0.0, squares_ = 0.0;
};

std::vector<double> MultiView::squared_errors(const ViewsEstimate& estimate, std::size_t track) const {
  std::vector<double> result;
  for (std::size_t v = 0; v < views_.times.size(); ++v) {
    if (!views_.places[track][v]) continue;
    const auto error = image_error(estimate.poses[v], estimate.points[track], *views_.places[track][v], camera_);
    result.push_back(error ? error->squaredNorm() : kBehind * kBehind);
  }
  return result;
}

void MultiView::update_cost(ViewsEstimate& estimate) const {
  const BoundedLoss loss{estimate.width};
  estimate.cost = 0.0;
  for (std::size_t i = 0; i < views_.tracks.size(); ++i) {
    for (const double squared : squared_errors(estimate, i)) estimate.cost += loss(squared);
  }
}

std::optional<ViewsEstimate> MultiView::start(const InitialGuess& guess, double width) const {
  std::map<TrackId, InversePoint> known;
  for (const Landmark& landmark : guess.landmarks) known[landmark.track] = to_inverse(landmark.position);
  const Vector6 motion = se3::log(guess.T1) / (guess.t1 - guess.t0);
  ViewsEstimate result;
  for (std::size_t v = 0; v < views_.times.size(); ++v) {
    std::vector<InversePoint> points;
    std::vector<Vector2> pixels;
    for (std::size_t i = 0; i < views_.tracks.size(); ++i) {
      const auto found = known.find(views_.tracks[i]);
      if (found == known.end() || !views_.places[i][v]) continue;
      points.push_back(found->second);
      pixels.push_back(*views_.places[i][v]);
    }
    SE3 T = se3::exp((views_.times[v] - guess.t0) * motion);
    if (v > 0 && v + 1 < views_.times.size()) {
      const auto found = resect(T, points, pixels, camera_, width);
      if (!found) return std::nullopt;
      T = found->T;
    }
    result.poses.push_back(T);
  }
  for (std::size_t i = 0; i < views_.tracks.size(); ++i) {
    const auto found = known.find(views_.tracks[i]);
    if (found != known.end()) {
      result.points.push_back(found->second);
      continue;
    }
    std::size_t v = 0;
    while (!views_.places[i][v]) ++v;
    result.points.push_back(to_inverse(result.poses[v] * camera_.ray(*views_.places[i][v]).normalized()));
  }
  normalise(result);
  result.width = width;
  update_cost(result);
  return result;
}

void MultiView::refine(ViewsEstimate& estimate, double width, int iterations) const {
  constexpr double kConverged = 1e-4, kMaxDamping = 1e6;
  double damping = 1e-3;
  estimate.width = width;
  update_cost(estimate);
  std::vector<Vector6> poses;
  std::vector<Vector3> points;
  for (int iteration = 0; iteration < iterations; ++iteration) {
    const Step step(*this, estimate);
    bool lower = false;
    while (!lower && damping < kMaxDamping) {
      if (step.solve(damping, poses, points)) {
        ViewsEstimate next = estimate;
        for (std::size_t v = 1; v < next.poses.size(); ++v) next.poses[v] = next.poses[v] * se3::exp(poses[v]);
        for (std::size_t i = 0; i < next.points.size(); ++i) {
          next.points[i] = moved(next.points[i], points[i]);
          next.points[i].inverse = std::max(next.points[i].inverse, kLeastInverse);
        }
        update_cost(next);
        lower = next.cost < estimate.cost;
        if (lower) {
          const bool converged = estimate.cost - next.cost < kConverged * estimate.cost;
          estimate = std::move(next);
          damping = std::max(0.1 * damping, 1e-9);
          if (converged) iterations = 0;
        }
      }
      if (!lower) damping = 10.0 * damping;
    }
    if (!lower) break;
    normalise(estimate);
  }
}

std::vector<double> MultiView::distance_sigmas(const ViewsEstimate& estimate) const {
  const Step step(*this, estimate);
  std::size_t farthest = 0;
  for (std::size_t v = 1; v < estimate.poses.size(); ++v) {
    if (estimate.poses[v].p.norm() > estimate.poses[farthest].p.norm()) farthest = v;
  }
  if (farthest == 0) return std::vector<double>(estimate.points.size(), std::numeric_limits<double>::infinity());
  constexpr double kLeastNoise = 0.5;
  const double noise = std::max(step.noise(), kLeastNoise * views_.sigma);
  const SE3& T = estimate.poses[farthest];
  std::vector<double> sigmas = step.inverse_sigmas(farthest, T.q.conjugate() * T.p.normalized());
  for (std::size_t i = 0; i < sigmas.size(); ++i) sigmas[i] *= noise / std::abs(estimate.points[i].inverse);
  return sigmas;
}

std::vector<double> MultiView::errors(const ViewsEstimate& estimate) const {
  std::vector<double> result;
  for (std::size_t i = 0; i < views_.tracks.size(); ++i) {
    const std::vector<double> squared = squared_errors(estimate, i);
    double sum = 0.0;
    for (const double s : squared) sum += std::sqrt(s);
    result.push_back(sum / static_cast<double>(squared.size()));
  }
  return result;
}

}  // namespace evbench
