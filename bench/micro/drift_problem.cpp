#include "bench/micro/drift_problem.hpp"

#include <cmath>
#include <utility>

#include "core/geometry/seen_point.hpp"
#include "core/smoother/factors.hpp"
#include "core/support/index.hpp"

namespace evbench {

using namespace smoother;

DriftProblem::DriftProblem(FactorGraph graph, const DriftModel& model)
    : graph_(std::move(graph)), layout_(graph_), observed_(graph_.intervals), offset_of_(observed_.size()) {
  if (model.sigma == 0.0) return;
  struct Newest {
    int offset = -1;
    double since = 0.0;  ///< [s], the landmark's first observation
    double at = 0.0;     ///< [s] from there, of the offset
  };
  std::vector<Newest> newest(graph_.landmarks.size());
  const double information = 1.0 / (model.sigma * model.sigma);
  const auto time_of = [&](double t) {
    return model.window > 0.0 ? (std::floor(t / model.window) + 0.5) * model.window : t;
  };
  for (std::size_t k = 1; k < observed_.size(); ++k) {
    for (const auto& group : observed_[k].groups()) {
      Newest& of = newest[index(group.landmark)];
      for (const Observation& z : observed_[k].of(group)) {
        if (of.offset < 0) of.since = z.t;
        const double at = time_of(z.t - of.since);
        if (of.offset < 0 || at != of.at) {
          Link link{-1, 0.0, information};
          if (of.offset >= 0 && model.time > 0.0) {
            const double kept = std::exp((of.at - at) / model.time);
            link = {of.offset, kept, information / (1.0 - kept * kept)};
          }
          links_.push_back(link);
          of.offset = static_cast<int>(links_.size()) - 1;
          of.at = at;
        }
        offset_of_[k].push_back(of.offset);
      }
    }
  }
  offsets_.assign(links_.size(), Vector2::Zero());
}

BatchSummary DriftProblem::solve(const BatchOptions& options) { return minimise(*this, options); }

Vector2 DriftProblem::innovation(int offset) const {
  const Link& link = links_[index(offset)];
  if (link.before < 0) return offsets_[index(offset)];
  return offsets_[index(offset)] - link.kept * offsets_[index(link.before)];
}

double DriftProblem::cost() const {
  double cost = evaluate(graph_).total();
  for (int i = 0; i < std::ssize(offsets_); ++i) {
    cost += 0.5 * links_[index(i)].information * innovation(i).squaredNorm();
  }
  return cost;
}

NormalEquations DriftProblem::linearise() const {
  NormalEquations equations(unknowns());
  add_factors(graph_, layout_, equations);
  if (offsets_.empty()) return equations;
  for (int k = 1; k < std::ssize(observed_); ++k) add_interval(k, equations);
  for (int i = 0; i < std::ssize(offsets_); ++i) {
    const auto [before, kept, information] = links_[index(i)];
    const Vector2 g = information * innovation(i);
    const Matrix2 H = information * Matrix2::Identity();
    equations.add_block(column(i), column(i), H);
    equations.add_gradient(column(i), g);
    if (before < 0) continue;
    equations.add_block(column(i), column(before), Matrix2(-kept * H));
    equations.add_block(column(before), column(before), Matrix2(kept * kept * H));
    equations.add_gradient(column(before), Vector2(-kept * g));
  }
  return equations;
}

/// A whitened residual grows by as much as its offset does: the couplings of each offset with the two states and with
/// its landmark.
void DriftProblem::add_interval(int k, NormalEquations& equations) const {
  const int x0 = layout_.state_offset[index(k - 1)], x1 = layout_.state_offset[index(k)];
  const GpInterval interval = graph_.interval(k);
  const GpInterval::Derivatives derivatives = interval.derivatives();
  const IntervalObservations& observations = graph_.intervals[index(k)];
  for (const auto& group : observations.groups()) {
    const Vector3& position = graph_.landmarks[index(group.landmark)].position;
    for (int i = group.begin; i < group.end;) {
      const int offset = offset_of_[index(k)][index(i)];
      Eigen::Matrix<double, 2, 12> H_x0 = Eigen::Matrix<double, 2, 12>::Zero(), H_x1 = H_x0;
      Matrix23 H_l = Matrix23::Zero();
      Matrix2 H = Matrix2::Zero();
      Vector2 g = Vector2::Zero();
      for (; i < group.end && offset_of_[index(k)][index(i)] == offset; ++i) {
        const Observation& z = observations.all()[index(i)];
        const Vector2 e = reprojection_residual(interval, position, z, graph_.camera);
        const GpInterval::Query query = interval.query(z.t, derivatives);
        const Vector3 q = query.T.inverse() * position;
        if (!(q.z() > 0.0)) continue;  // a constant
        const double weight = graph_.loss.weight(e.squaredNorm());
        const Matrix23 J = weight * (z.whitening * graph_.camera.project_jacobian(q));
        const Matrix26 J_T = J * seen_point_jacobian(q);
        H_x0 += J_T * query.J0.topRows<6>();
        H_x1 += J_T * query.J1.topRows<6>();
        H_l += J * query.T.R().transpose();
        H += weight * Matrix2::Identity();
        g += weight * e;
      }
      equations.add_block(column(offset), x0, H_x0);
      equations.add_block(column(offset), x1, H_x1);
      equations.add_block(column(offset), layout_.landmark_offset[index(group.landmark)], H_l);
      equations.add_block(column(offset), column(offset), H);
      equations.add_gradient(column(offset), g);
    }
  }
}

void DriftProblem::apply(const Eigen::VectorXd& step) {
  apply_step(graph_, layout_, step);
  for (int i = 0; i < std::ssize(offsets_); ++i) offsets_[index(i)] += step.segment<2>(column(i));
  take_offsets_away();
}

void DriftProblem::restore(const Estimate& estimate) {
  estimate.graph.restore(graph_);
  offsets_ = estimate.offsets;
  take_offsets_away();
}

void DriftProblem::take_offsets_away() {
  if (offsets_.empty()) return;
  for (std::size_t k = 1; k < observed_.size(); ++k) {
    IntervalObservations rest;
    for (const auto& group : observed_[k].groups()) {
      for (int i = group.begin; i < group.end; ++i) {
        Observation z = observed_[k].all()[index(i)];
        z.pixel -= z.whitening.inverse(offsets_[index(offset_of_[k][index(i)])]);
        rest.add(group.landmark, z);
      }
    }
    graph_.intervals[k] = std::move(rest);
  }
}

DriftCovariance::DriftCovariance(const DriftProblem& problem) : problem_(problem) {
  cholesky_.compute(problem.linearise().matrix());
}

std::optional<Matrix6> DriftCovariance::relative(int i, int j) const {
  if (cholesky_.info() != Eigen::Success) return std::nullopt;
  const std::vector<ControlState>& states = problem_.graph().states;
  // (T_i Exp δ_i)⁻¹ T_j Exp δ_j = T_i⁻¹ T_j Exp(δ_j − Ad(T_j⁻¹ T_i) δ_i)
  const SE3 back = states[index(j)].T.inverse() * states[index(i)].T;
  Eigen::MatrixXd J = Eigen::MatrixXd::Zero(problem_.unknowns(), 6);
  J.middleRows<6>(problem_.layout().state_offset[index(i)]) = -se3::adjoint(back).transpose();
  J.middleRows<6>(problem_.layout().state_offset[index(j)]).setIdentity();
  return Matrix6(J.transpose() * cholesky_.solve(J));
}

}  // namespace evbench
