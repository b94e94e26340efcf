#include "backends/gp_map/modules/map_validation.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "core/smoother/smoother.hpp"
#include "core/support/median.hpp"

namespace evbench::gp_map {
namespace {

constexpr int kFewest = 8;           ///< landmarks of a half
constexpr double kTolerance = 1e-7;  ///< relative change of the cost that ends the iterations
constexpr double kShortPath = 0.1;   ///< of the landmarks' median distance from the first state

/// Positions of the states as estimated by the landmarks with even or with odd numbers, of those that are left.
Eigen::Matrix3Xd positions_by_half(const FactorGraph& graph, bool odd, int iterations) {
  FactorGraph half = graph;
  bool other = odd;
  for (int j = 0; j < std::ssize(graph.landmarks); ++j) {
    if (!graph.landmarks[index(j)].alive) continue;
    if (other) half.remove_landmark(j);
    other = !other;
  }
  Smoother smoother(std::move(half), {});
  smoother.optimise(iterations, kTolerance);
  Eigen::Matrix3Xd positions(3, std::ssize(graph.states));
  Eigen::Index i = 0;
  for (const ControlState& state : smoother.graph().states) positions.col(i++) = state.T.p;
  return positions;
}

/// Distance between corresponding positions after alignment by a similarity.
double mean_square(const Eigen::Matrix3Xd& positions, const Eigen::Matrix3Xd& reference) {
  if (!positions.allFinite()) return std::numeric_limits<double>::infinity();
  const Eigen::Matrix4d S = Eigen::umeyama(positions, reference, true);
  const Eigen::Matrix3Xd aligned = (S.topLeftCorner<3, 3>() * positions).colwise() + S.topRightCorner<3, 1>();
  return (aligned - reference).colwise().squaredNorm().mean();
}

}  // namespace

void ValidationOptions::declare(OptionSet& set) {
  set.add("enabled", enabled,
          "at the end each half of the landmarks estimates the trajectory alone; not with a lag or without "
          "final_iterations");
  set.add("disagreement", disagreement,
          "root mean square distance of both from the whole trajectory, as a share of the path, above which the run "
          "is degraded")
      .above(0.0);
  set.add("iterations", iterations, "of each half, at most").range(1, 1000);
}

std::optional<double> difference_of_halves(const FactorGraph& graph, const ValidationOptions& options) {
  std::vector<double> distances;
  for (const FactorGraph::Landmark& landmark : graph.landmarks) {
    if (landmark.alive) distances.push_back((landmark.position - graph.states.front().T.p).norm());
  }
  if (std::ssize(distances) < 2 * kFewest || graph.states.size() < 3) return std::nullopt;
  Eigen::Matrix3Xd whole(3, std::ssize(graph.states));
  double path = 0.0;
  for (std::size_t i = 0; i < graph.states.size(); ++i) {
    whole.col(static_cast<Eigen::Index>(i)) = graph.states[i].T.p;
    if (i > 0) path += (graph.states[i].T.p - graph.states[i - 1].T.p).norm();
  }
  path = std::max(path, kShortPath * median(std::move(distances)));
  double square = 0.0;
  for (const bool odd : {false, true})
    square += 0.5 * mean_square(positions_by_half(graph, odd, options.iterations), whole);
  return std::isfinite(square) ? std::sqrt(square) / path : std::numeric_limits<double>::infinity();
}

}  // namespace evbench::gp_map
