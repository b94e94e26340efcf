#include "backends/bundle_adjustment/bundle_solver.hpp"

#include <ceres/problem.h>
#include <ceres/solver.h>

#include <algorithm>
#include <cmath>

#include "backends/bundle_adjustment/reprojection.hpp"
#include "core/support/index.hpp"

namespace evbench::bundle_adjustment {
namespace {

constexpr int kMostDensePoses = 40;  // above, a sparse factorisation of the reduced camera matrix pays

/// The part of the map in a solve, in blocks that Ceres writes to.
struct Blocks {
  std::vector<PoseBlock> poses;  // by view
  std::vector<bool> used;        // by view
  std::vector<std::pair<TrackId, Vector3>> landmarks;
};

bool variable(int view, const SolveScope& scope) { return view >= scope.first_variable && view != scope.origin; }

Blocks gather(const Reconstruction& map, const SolveScope& scope) {
  Blocks blocks;
  for (const View& view : map.views) blocks.poses.emplace_back(view.T);
  blocks.used.assign(map.views.size(), false);
  for (const auto& [id, track] : map.tracks) {
    if (!track.position || track.sightings.back().view < scope.first_variable) continue;
    if (track.sightings.front().view > scope.last) continue;
    const auto counts = [&](const TrackSighting& z) {
      return z.view >= scope.first_used && map.views[index(z.view)].estimated();
    };
    if (std::count_if(track.sightings.begin(), track.sightings.end(), counts) >= 2) {
      blocks.landmarks.emplace_back(id, *track.position);
    }
  }
  return blocks;
}

}  // namespace

SolveReport solve(Reconstruction& map, const PinholeCamera& camera, const SolveScope& scope,
                  const SolverOptions& options) {
  Blocks blocks = gather(map, scope);
  SolveReport report;
  const std::unique_ptr<ceres::LossFunction> loss = make_loss(options.loss, options.loss_width);
  PoseManifold pose_manifold;
  FixedDistanceManifold scale_manifold(map.views[index(scope.origin)].T.p);

  ceres::Problem::Options problem_options;
  problem_options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  problem_options.manifold_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  problem_options.disable_all_safety_checks = true;
  ceres::Problem problem(problem_options);
  auto* ordering = new ceres::ParameterBlockOrdering;
  ceres::Solver::Options solver_options;
  solver_options.linear_solver_ordering.reset(ordering);

  for (auto& [id, position] : blocks.landmarks) {
    ordering->AddElementToGroup(position.data(), 0);
    for (const TrackSighting& z : map.tracks.at(id).sightings) {
      const auto view = static_cast<std::size_t>(z.view);
      if (z.view < scope.first_used || !map.views[view].estimated()) continue;
      blocks.used[view] = true;
      problem.AddResidualBlock(new ReprojectionCost(z.pixel, z.noise, camera), loss.get(), blocks.poses[view].values,
                               position.data());
      ++report.observations;
    }
  }
  for (std::size_t i = 0; i < blocks.poses.size(); ++i) {
    if (!blocks.used[i]) continue;
    double* const values = blocks.poses[i].values;
    const int view = static_cast<int>(i);
    ordering->AddElementToGroup(values, 1);
    if (!variable(view, scope)) {
      problem.SetParameterBlockConstant(values);
      continue;
    }
    problem.SetManifold(values, view == scope.scale ? static_cast<ceres::Manifold*>(&scale_manifold) : &pose_manifold);
    ++report.poses;
  }
  report.landmarks = static_cast<int>(blocks.landmarks.size());
  if (report.poses == 0) return report;

  solver_options.linear_solver_type = report.poses <= kMostDensePoses ? ceres::DENSE_SCHUR : ceres::SPARSE_SCHUR;
  solver_options.num_threads = 1;
  solver_options.max_num_iterations = options.iterations;
  solver_options.function_tolerance = 1e-5;
  solver_options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(solver_options, &problem, &summary);
  report.cost = summary.final_cost;
  report.iterations = static_cast<int>(summary.iterations.size());
  report.usable = summary.IsSolutionUsable() && std::isfinite(summary.final_cost);
  if (!report.usable) return report;
  for (std::size_t i = 0; i < blocks.poses.size(); ++i) {
    if (blocks.used[i]) map.views[i].T = blocks.poses[i].pose();
  }
  for (const auto& [id, position] : blocks.landmarks) map.tracks.at(id).position = position;
  return report;
}

}  // namespace evbench::bundle_adjustment
