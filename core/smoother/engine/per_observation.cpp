#include "core/geometry/seen_point.hpp"
#include "core/smoother/engine/engine.hpp"

// Per-observation updates: the newest two states follow each observation of the interval between them.
namespace evbench::smoother {
namespace {

ObservationRows linearise(const GpInterval& interval, const GpInterval::Derivatives& derivatives,
                          const PinholeCamera& camera, const Vector3& landmark, const Observation& z) {
  ObservationRows rows;
  const GpInterval::Query at_z = interval.query(z.t, derivatives);
  const Vector3 q = at_z.T.inverse() * landmark;
  if (!(q.z() > 0.0)) return rows;  // its cost is constant there
  const Matrix23 D = z.whitening * camera.project_jacobian(q);
  rows.e = z.whitening * Vector2(camera.project(q) - z.pixel);
  rows.landmark = D * at_z.T.R().transpose();
  const Matrix26 pose = D * seen_point_jacobian(q);
  rows.states.resize(2, at_z.J0.cols() + at_z.J1.cols());
  rows.states << pose * at_z.J0.topRows<6>(), pose * at_z.J1.topRows<6>();
  return rows;
}

}  // namespace

/// Builds the factor of the open interval from the root of the last update.
bool Engine::open_newest_interval() {
  const int newest = static_cast<int>(graph_.states.size()) - 1;
  if (live_.is_of(newest)) return true;
  if (newest < 1 || factorisation_.done() != newest - 1 || restart_ < newest) return false;
  if (factorisation_.awaits_return()) return false;
  const ControlState& older = points_.state(newest - 1);
  const ControlState& newer = points_.state(newest);
  live_interval_.emplace(older, newer, graph_.motion_prior);
  live_derivatives_ = live_interval_->derivatives();
  return live_.build(factorisation_.root(), newest, points_.interval(graph_, newest));
}

bool Engine::add_observation_and_update(int landmark, const Observation& observation) {
  const int newest = static_cast<int>(graph_.states.size()) - 1;
  // Other observations take effect with the next update.
  const bool live = graph_.interval_of(observation.t) == newest && open_newest_interval() && live_.has(landmark);
  if (!insert(landmark, observation) || !live) return false;
  const ObservationRows rows = linearise(*live_interval_, live_derivatives_, graph_.camera, points_.landmark(landmark),
                                         graph_.scaled(landmark, observation));
  live_.add(landmark, rows, graph_.loss.weight(rows.e.squaredNorm()));
  const PairVector delta = live_.solve_states();
  if (!delta.allFinite()) return false;
  const int n = graph_.state_size();
  // The separator of older states has changed.
  factorisation_.stage(newest - 1).skipped +=
      size_of_state(newest - 1, delta.head(n) - points_.state_delta(newest - 1));
  points_.set_state_delta(graph_, newest - 1, delta.head(n));
  points_.set_state_delta(graph_, newest, delta.tail(n));
  return true;
}

}  // namespace evbench::smoother
