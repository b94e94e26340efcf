#include "backends/gp_map/observation_follower.hpp"

namespace evbench::gp_map {

void ObservationFollower::open(Smoother& smoother, double ahead) {
  if (open_) return;
  smoother.add_state_at(ahead);
  smoother.open_newest_interval();
  open_ = true;
}

void ObservationFollower::follow(Smoother& smoother, int landmark, const Observation& observation) {
  smoother.add_observation_and_update(landmark, observation);
  followed_.emplace_back(landmark, observation);
}

void ObservationFollower::close(Smoother& smoother, double t) {
  if (open_ && smoother.graph().states.back().t != t) {
    smoother.remove_newest_state();
    smoother.add_state_at(t);
    for (const auto& [landmark, observation] : followed_) smoother.add_observation(landmark, observation);
  }
  open_ = false;
  followed_.clear();
}

}  // namespace evbench::gp_map
