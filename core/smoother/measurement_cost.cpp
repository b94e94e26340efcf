#include "core/smoother/engine/lane_loss.hpp"
#include "core/smoother/engine/observation_geometry.hpp"
#include "core/smoother/factors.hpp"

// Lanes run over the observations of an interval, of any landmarks.
namespace evbench::smoother {
namespace {

using namespace lanes;  // NOLINT: this file works by lanes

/// Calls visit(residual, observed, index of the group of each lane's observation).
template <class Visit>
void for_each_residual(const FactorGraph& graph, int k, const GpInterval& interval, Visit visit) {
  const IntervalObservations& observations = graph.intervals[index(k)];
  const auto& groups = observations.groups();
  const Matrix3 R = interval.T0().R().transpose();
  with_kind_of(interval, [&]<int orders, Range range>() {
    const Interval<orders> shared(interval);
    std::array<std::size_t, kLanes> places{};
    Lane3 m;
    Measured observed(shared.t0);
    std::size_t lane = 0;
    const auto finish = [&] {
      const Motion moved = motion(tangent<range, orders>(shared, basis_at(shared, observed.t)));
      visit(residual_of(graph.camera, moved.into_camera(m), observed), observed, places);
      observed = Measured(shared.t0);
      lane = 0;
    };
    for (std::size_t place = 0; place < groups.size(); ++place) {
      const Vector3 local = R * (graph.landmarks[index(groups[place].landmark)].position - interval.T0().p);
      for (const Observation& z : observations.of(groups[place])) {
        m.x[lane] = local.x();
        m.y[lane] = local.y();
        m.z[lane] = local.z();
        places[lane] = place;
        observed.set(lane, z);
        if (++lane == kLanes) finish();
      }
    }
    if (lane > 0) finish();
  });
}

}  // namespace

double measurement_cost(const FactorGraph& graph, int k, const GpInterval& interval) {
  Lane cost{};
  for_each_residual(graph, k, interval, [&](const Residual& r, const Measured& observed, const auto&) {
    cost += observed.present > 0.0 ? loss_of(graph.loss, r.square).value : Lane{};
  });
  return 0.5 * sum(cost);
}

std::vector<ErrorSum> reprojection_errors(const FactorGraph& graph, int k) {
  std::vector<ErrorSum> sums(graph.intervals[index(k)].groups().size());
  const GpInterval interval = graph.interval(k);
  for_each_residual(graph, k, interval, [&](const Residual& r, const Measured& observed, const auto& places) {
    const Lane error = r.px();
    for (std::size_t i = 0; i < kLanes; ++i) {
      if (!(observed.present[i] > 0.0)) continue;
      ErrorSum& sum = sums[places[i]];
      ++sum.count;
      r.in_front[i] != 0 ? sum.px += error[i] : ++sum.behind;
    }
  });
  return sums;
}

}  // namespace evbench::smoother
