#include "solver.hpp"

#include <ceres/loss_function.h>
#include <ceres/problem.h>
#include <ceres/solver.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <memory>

#include "cost_functions.hpp"

namespace spline_map {
namespace {

constexpr double kAnchorSigma = 1e-4;   // [rad, units, log] of the gauge: far below the noise, well conditioned
constexpr std::size_t kMostDense = 60;  // knots; above, a sparse factorisation of the reduced matrix is faster
constexpr std::size_t kSegmentKnots = 4;

std::unique_ptr<ceres::LossFunction> make_loss(const SolverOptions& options) {
  if (options.loss == "huber") return std::make_unique<ceres::HuberLoss>(options.loss_width);
  if (options.loss == "cauchy") return std::make_unique<ceres::CauchyLoss>(options.loss_width);
  return nullptr;
}

ceres::Problem::Options problem_options(ceres::EvaluationCallback* callback) {
  ceres::Problem::Options options;
  options.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  options.manifold_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  options.evaluation_callback = callback;
  options.disable_all_safety_checks = true;
  return options;
}

/// One solve: the Ceres problem and everything that it refers to. It changes the spline's knots in place.
class Solve {
 public:
  Solve(Spline& spline, const evbench::PinholeCamera& camera, const SolveScope& scope, const SolverOptions& options)
      : spline_(spline),
        camera_(camera),
        scope_(scope),
        options_(options),
        first_segment_(scope.first_knot < kSegmentKnots ? 0 : scope.first_knot - kSegmentKnots + 1),
        loss_(make_loss(options)),
        segments_(spline, first_segment_),
        problem_(problem_options(&segments_)) {}

  void add_knots(const std::vector<MotionDensity>& densities);
  void add_gauge(const Gauge& gauge);
  void add_landmarks(const Landmarks& landmarks);
  SolveReport run(Landmarks& landmarks);

 private:
  double* knot(std::size_t k) { return spline_.knots()[k].values; }
  void add_observation(const evbench::UndistortedObservation& z, double* landmark);

  Spline& spline_;
  const evbench::PinholeCamera& camera_;
  const SolveScope& scope_;
  const SolverOptions& options_;
  std::size_t first_segment_;  ///< the first segment that depends on a variable knot
  std::unique_ptr<ceres::LossFunction> loss_;
  KnotManifold manifold_;
  std::deque<AccelerationCost> accelerations_;
  std::unique_ptr<PoseAnchorCost> pose_anchor_;
  std::unique_ptr<BaselineCost> baseline_;
  std::deque<ReprojectionCost> costs_;  // deques: addresses of elements stay valid
  std::deque<HeldReprojectionCost> held_costs_;
  std::vector<std::pair<evbench::TrackId, Vector3>> positions_;
  PreparedSegments segments_;
  ceres::Problem problem_;
  SolveReport report_;
};

void Solve::add_knots(const std::vector<MotionDensity>& densities) {
  const std::size_t count = spline_.knots().size();
  for (std::size_t k = first_segment_; k < count; ++k) {
    problem_.AddParameterBlock(knot(k), 7, &manifold_);
    if (k < scope_.first_knot) problem_.SetParameterBlockConstant(knot(k));
  }
  for (std::size_t k = std::max<std::size_t>(first_segment_, 1); k + 1 < count; ++k) {
    if (k + 1 < scope_.first_knot) continue;
    accelerations_.emplace_back(densities[k].rotation, densities[k].translation, spline_.spacing());
    problem_.AddResidualBlock(&accelerations_.back(), nullptr, knot(k - 1), knot(k), knot(k + 1));
  }
  report_.knots = static_cast<int>(count - scope_.first_knot);
}

void Solve::add_gauge(const Gauge& gauge) {
  if (scope_.first_knot > 0) return;
  pose_anchor_ = std::make_unique<PoseAnchorCost>(gauge.first, kAnchorSigma);
  problem_.AddResidualBlock(pose_anchor_.get(), nullptr, knot(0), knot(1), knot(2), knot(3));
  std::map<std::size_t, double> weights;  // by knot; the two times may share knots
  const auto add = [&](double t, double sign) {
    const Spline::Place at = spline_.place(t);
    const BasisWeights basis(at.u);
    for (std::size_t j = 0; j < kSegmentKnots; ++j) weights[at.segment + j] += sign * basis.plain[j];
  };
  add(gauge.from, -1.0);
  add(gauge.to, 1.0);
  std::vector<double*> blocks;
  std::vector<double> values;
  for (const auto& [k, weight] : weights) {
    blocks.push_back(knot(k));
    values.push_back(weight);
  }
  baseline_ = std::make_unique<BaselineCost>(std::move(values), gauge.distance, kAnchorSigma);
  problem_.AddResidualBlock(baseline_.get(), nullptr, blocks);
}

void Solve::add_observation(const evbench::UndistortedObservation& z, double* landmark) {
  const Spline::Place at = spline_.place(z.t);
  const std::size_t s = at.segment;
  ++report_.observations;
  if (s >= first_segment_) {
    costs_.emplace_back(segments_[s], at.u, z, camera_);
    problem_.AddResidualBlock(&costs_.back(), loss_.get(), knot(s), knot(s + 1), knot(s + 2), knot(s + 3), landmark);
  } else {
    held_costs_.emplace_back(spline_.segment(s).pose(at.u), z, camera_);
    problem_.AddResidualBlock(&held_costs_.back(), loss_.get(), landmark);
  }
}

void Solve::add_landmarks(const Landmarks& landmarks) {
  const double variable_from = spline_.start() + static_cast<double>(first_segment_) * spline_.spacing();
  for (const auto& [id, landmark] : landmarks) {
    if (landmark.observations.empty() || landmark.observations.back().t < variable_from) continue;
    positions_.emplace_back(id, landmark.position);
  }
  for (auto& [id, position] : positions_) {
    const auto& observations = landmarks.at(id).observations;
    const auto first =
        std::ranges::lower_bound(observations, scope_.held_from, {}, &evbench::UndistortedObservation::t);
    for (const evbench::UndistortedObservation& z : std::span(first, observations.end())) {
      add_observation(z, position.data());
    }
  }
  report_.landmarks = static_cast<int>(positions_.size());
}

SolveReport Solve::run(Landmarks& landmarks) {
  ceres::Solver::Options options;
  auto ordering = std::make_shared<ceres::ParameterBlockOrdering>();
  for (auto& [id, position] : positions_) ordering->AddElementToGroup(position.data(), 0);
  for (std::size_t k = first_segment_; k < spline_.knots().size(); ++k) ordering->AddElementToGroup(knot(k), 1);
  options.linear_solver_ordering = ordering;
  const std::size_t variable = spline_.knots().size() - scope_.first_knot;
  options.linear_solver_type = variable <= kMostDense ? ceres::DENSE_SCHUR : ceres::SPARSE_SCHUR;
  options.num_threads = 1;
  options.max_num_iterations = options_.iterations;
  options.function_tolerance = options_.tolerance;
  options.logging_type = ceres::SILENT;
  const std::vector<Knot> before = spline_.knots();
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem_, &summary);
  report_.cost = summary.final_cost;
  report_.iterations = static_cast<int>(summary.iterations.size());
  report_.usable = summary.IsSolutionUsable() && std::isfinite(summary.final_cost);
  if (!report_.usable) {
    spline_.knots() = before;
    return report_;
  }
  for (Knot& k : spline_.knots()) k = Knot(k.rotation().normalized(), k.position());
  for (const auto& [id, position] : positions_) landmarks.at(id).position = position;
  return report_;
}

}  // namespace

SolveReport solve(Spline& spline, Landmarks& landmarks, const std::vector<MotionDensity>& densities,
                  const evbench::PinholeCamera& camera, const Gauge& gauge, const SolveScope& scope,
                  const SolverOptions& options) {
  Solve problem(spline, camera, scope, options);
  problem.add_knots(densities);
  problem.add_gauge(gauge);
  problem.add_landmarks(landmarks);
  return problem.run(landmarks);
}

}  // namespace spline_map
