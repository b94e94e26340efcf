#include "core/smoother/testing/rounding.hpp"

#include <Eigen/Cholesky>
#include <limits>

#include "core/smoother/factors.hpp"
#include "core/support/index.hpp"

namespace evbench::smoother::testing {
namespace {

using Real = long double;  ///< the rounding of double is measured here
using Matrix = Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic>;
using Vector = Eigen::Matrix<Real, Eigen::Dynamic, 1>;

/// H, lower triangle, and −g: states first, then the landmarks that are observed.
struct DenseSystem {
  Matrix H;
  Vector b;

  explicit DenseSystem(const FactorGraph& graph) {
    int size = graph.state_size() * static_cast<int>(graph.states.size());
    std::vector<int> row(graph.landmarks.size(), -1);
    for (std::size_t j = 0; j < row.size(); ++j) {
      if (graph.landmarks[j].intervals.empty()) continue;
      row[j] = size;
      size += 3;
    }
    H.setZero(size, size);
    b.setZero(size);
    for (int k = 0; k < static_cast<int>(graph.states.size()); ++k) add_state(graph, k, row);
    for (std::size_t j = 0; j < row.size(); ++j) {
      const LandmarkPrior& prior = graph.landmarks[j].prior;
      if (row[j] < 0 || !std::isfinite(prior.sigma)) continue;
      const double information = 1.0 / (prior.sigma * prior.sigma);
      add(row[j], row[j], Matrix3(information * Matrix3::Identity()));
      b.segment(row[j], 3) += (information * (prior.position - graph.landmarks[j].position)).cast<Real>();
    }
  }

 private:
  template <class Block>
  void add(int r, int c, const Block& block) {
    H.block(r, c, block.rows(), block.cols()) += block.template cast<Real>();
  }

  void add_state(const FactorGraph& graph, int k, const std::vector<int>& row) {
    const int n = graph.state_size();
    const StateSystem priors = state_priors(graph, k);
    add(n * k, n * k, priors.H);
    b.segment(n * k, n) -= priors.g.cast<Real>();
    if (k == 0) return;
    IntervalLinearisation linear;
    linearise_interval(graph, k, linear);
    add(n * (k - 1), n * (k - 1), linear.states);
    b.segment(n * (k - 1), 2 * n) -= linear.gradient.cast<Real>();
    for (const auto& coupling : linear.couplings) {
      const int l = row[index(coupling.landmark)];
      add(l, l, coupling.landmark_landmark);
      add(l, n * (k - 1), coupling.landmark_states);
      b.segment(l, 3) -= coupling.gradient.cast<Real>();
    }
  }
};

}  // namespace

std::vector<RoundingBound> rounding_bounds(const FactorGraph& graph) {
  constexpr double kRounding = 1.1e-16, kGrowth = 10.0;  // u and c; at most 2.3 u in 12,156 random problems
  constexpr double kInfinite = std::numeric_limits<double>::infinity();
  const DenseSystem system(graph);
  const Vector D = system.H.diagonal().cwiseSqrt();
  const Vector inverse_D = D.cwiseInverse();
  const Matrix K = inverse_D.asDiagonal() * system.H * inverse_D.asDiagonal();
  const Eigen::LLT<Matrix> cholesky(K);  // of the lower triangle
  if (cholesky.info() != Eigen::Success) return std::vector<RoundingBound>(graph.states.size(), {kInfinite, kInfinite});
  const Matrix inverse_K = cholesky.solve(Matrix::Identity(K.rows(), K.cols()));
  const Vector scaled = inverse_K * (inverse_D.asDiagonal() * system.b);
  const auto share = static_cast<double>(std::sqrt(inverse_K.norm()) * scaled.norm()) * kGrowth * kRounding;
  const Eigen::VectorXd delta = inverse_D.cwiseProduct(scaled).cast<double>();
  const Eigen::VectorXd sigma = inverse_K.diagonal().cwiseSqrt().cwiseProduct(inverse_D).cast<double>();
  std::vector<RoundingBound> bounds;
  for (int k = 0; k < static_cast<int>(graph.states.size()); ++k) {
    const int i = k * graph.state_size();
    const double turned = delta.segment<3>(i + 3).norm() * sigma.segment<3>(i).norm();  // δT = Exp(φ, ρ)
    bounds.push_back({share * (sigma.segment<3>(i + 3).norm() + turned), share * sigma.segment<6>(i + 6).norm()});
  }
  return bounds;
}

}  // namespace evbench::smoother::testing
