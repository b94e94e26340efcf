#include "core/smoother/engine/landmark_views.hpp"

#include <vector>

#include "core/smoother/testing/drawn_problem.hpp"
#include "core/testing/catch2.hpp"
#include "core/testing/differences.hpp"

namespace evbench::smoother {
namespace {

/// A solved problem whose landmarks are seen in up to 20 intervals, with another loss.
FactorGraph solved_problem(const RobustLoss& loss) {
  FactorGraph graph = testing::DrawnProblem({.pixel_sigma = 1.0}, 1).solve_incrementally().graph();
  graph.loss = loss;
  return graph;
}

const std::vector<RobustLoss> kLosses = {RobustLoss(), RobustLoss(RobustLoss::Kind::huber, 1.5),
                                         RobustLoss(RobustLoss::Kind::cauchy, 2.0)};

}  // namespace

TEST_CASE("The cost of a landmark's views equals that of its observations and its prior, at any position") {
  for (const RobustLoss& loss : kLosses) {
    const FactorGraph graph = solved_problem(loss);
    for (int j = 0; j < static_cast<int>(graph.landmarks.size()); ++j) {
      const LandmarkViews views(graph, j);
      const FactorGraph::Landmark& landmark = graph.landmarks[index(j)];
      for (const Vector3& moved : {Vector3(0, 0, 0), Vector3(0.1, -0.2, 0.3), Vector3(0, 0, -20)}) {
        const Vector3 position = landmark.position + moved;
        double expected = 0.5 * residual(landmark.prior, position).squaredNorm();
        for_each_observation(graph, j, {}, [&](const GpInterval& interval, const Observation& z) {
          expected += 0.5 * loss.value(reprojection_residual(interval, position, z, graph.camera).squaredNorm());
        });
        CHECK(views.cost(position) == Approx(expected).epsilon(1e-10));
      }
    }
  }
}

TEST_CASE("A landmark's own normal equations are the sums over its observations and its prior") {
  for (const RobustLoss& loss : kLosses) {
    const FactorGraph graph = solved_problem(loss);
    for (int j = 0; j < static_cast<int>(graph.landmarks.size()); ++j) {
      const LandmarkViews views(graph, j);
      const FactorGraph::Landmark& landmark = graph.landmarks[index(j)];
      const Vector3 position = landmark.position + Vector3(0.01, -0.02, 0.03);
      const LandmarkViews::System system = views.linearise(position);
      Matrix3 H = Matrix3::Identity() / (landmark.prior.sigma * landmark.prior.sigma);
      Vector3 g = H * (position - landmark.prior.position);
      for_each_observation(graph, j, {}, [&](const GpInterval& interval, const Observation& z) {
        const SE3 T = interval.pose(z.t).inverse();
        const Matrix23 J = z.whitening * Matrix23(graph.camera.project_jacobian(T * position) * T.R());
        const Vector2 e = reprojection_residual(interval, position, z, graph.camera);
        H += loss.weight(e.squaredNorm()) * J.transpose() * J;
        g += loss.weight(e.squaredNorm()) * J.transpose() * e;
      });
      CHECK(evbench::testing::relative_error(system.H, H) < 1e-9);
      CHECK(evbench::testing::relative_error(system.g, g) < 1e-9);
    }
  }
}

}  // namespace evbench::smoother
