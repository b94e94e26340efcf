#include "backends/rotation_averaging/rotation_graph.hpp"

#include <Eigen/SparseCholesky>
#include <cmath>

#include "core/geometry/nearest_rotation.hpp"
#include "core/geometry/so3.hpp"

namespace evbench {

std::optional<AlignedDirections> align_directions(std::span<const std::pair<Vector3, Vector3>> left_and_right,
                                                  double scale) {
  constexpr int kRounds = 8;
  if (left_and_right.size() < 2) return std::nullopt;
  AlignedDirections result{Eigen::Quaterniond::Identity(), 0.0, 0.0};
  std::vector<double> weights(left_and_right.size(), 1.0);
  for (int round = 0; round < kRounds; ++round) {
    Matrix3 M = Matrix3::Zero();
    for (std::size_t i = 0; i < weights.size(); ++i) {
      M += weights[i] * left_and_right[i].first * left_and_right[i].second.transpose();
    }
    result.R = Eigen::Quaterniond(nearest_rotation(M).R);
    double squares = 0.0;
    result.weight = 0.0;
    for (std::size_t i = 0; i < weights.size(); ++i) {
      const double squared = (left_and_right[i].first - result.R * left_and_right[i].second).squaredNorm();
      weights[i] = 1.0 / (1.0 + squared / (scale * scale));
      squares += weights[i] * squared;
      result.weight += weights[i];
    }
    result.residual = std::sqrt(squares / std::max(result.weight, 1e-12));
  }
  return result;
}

void average_rotations(std::span<const RotationEdge> edges, double scale, std::vector<Eigen::Quaterniond>& rotations) {
  constexpr int kRounds = 20;
  constexpr double kSmallest = 1e-9;  // [rad]
  if (rotations.size() < 2 || edges.empty()) return;
  const auto unknowns = static_cast<Eigen::Index>(3 * (rotations.size() - 1));
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver;
  for (int round = 0; round < kRounds; ++round) {
    // R ← R Exp(δ): the residual Log(R_edgeᵀ R_leftᵀ R_right) changes by δ_right - (R_rightᵀ R_left) δ_left, about.
    std::vector<Eigen::Triplet<double>> entries;
    Eigen::VectorXd g = Eigen::VectorXd::Zero(unknowns);
    const auto add = [&](std::size_t row, std::size_t column, const Matrix3& block) {
      if (row == 0 || column == 0) return;
      for (int i = 0; i < 3; ++i) {
        for (int k = 0; k < 3; ++k) {
          entries.emplace_back(static_cast<int>(3 * (row - 1)) + i, static_cast<int>(3 * (column - 1)) + k,
                               block(i, k));
        }
      }
    };
    const auto add_gradient = [&](std::size_t row, const Vector3& part) {
      if (row > 0) g.segment<3>(static_cast<Eigen::Index>(3 * (row - 1))) += part;
    };
    for (std::size_t i = 1; i < rotations.size(); ++i)
      add(i, i, 1e-9 * Matrix3::Identity());  // for those without an edge
    for (const RotationEdge& edge : edges) {
      const Eigen::Quaterniond relative = rotations[edge.left].conjugate() * rotations[edge.right];
      const Vector3 e = so3::log((edge.R.conjugate() * relative).normalized());
      const double weight = edge.weight / (1.0 + e.squaredNorm() / (scale * scale));
      const Matrix3 J_left = -relative.conjugate().toRotationMatrix();
      add(edge.right, edge.right, weight * Matrix3::Identity());
      add(edge.left, edge.left, weight * Matrix3::Identity());
      add(edge.right, edge.left, weight * J_left);
      add(edge.left, edge.right, weight * J_left.transpose());
      add_gradient(edge.right, weight * e);
      add_gradient(edge.left, weight * J_left.transpose() * e);
    }
    Eigen::SparseMatrix<double> H(unknowns, unknowns);
    H.setFromTriplets(entries.begin(), entries.end());
    solver.compute(H);
    if (solver.info() != Eigen::Success) return;
    const Eigen::VectorXd step = solver.solve(-g);
    if (!step.allFinite()) return;
    for (std::size_t i = 1; i < rotations.size(); ++i) {
      rotations[i] = (rotations[i] * so3::exp(step.segment<3>(static_cast<Eigen::Index>(3 * (i - 1))))).normalized();
    }
    if (step.lpNorm<Eigen::Infinity>() < kSmallest) return;
  }
}

}  // namespace evbench
