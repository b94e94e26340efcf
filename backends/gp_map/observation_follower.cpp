#include "backends/gp_map/observation_follower.hpp"

namespace evbench::gp_map {

void add_extrapolated_state(Engine& engine, double t) {
  const ControlState& newest = engine.graph().states.back();
  engine.add_state(extrapolate(newest, t - newest.t));
}

void ObservationFollower::open(Engine& engine, double ahead) {
  if (open_) return;
  add_extrapolated_state(engine, ahead);
  engine.open_newest();
  open_ = true;
}

void ObservationFollower::follow(Engine& engine, int landmark, const Observation& observation) {
  engine.observe(landmark, observation);
  followed_.emplace_back(landmark, observation);
}

void ObservationFollower::close(Engine& engine, double t) {
  if (open_ && engine.graph().states.back().t != t) {
    engine.remove_newest_state();
    add_extrapolated_state(engine, t);
    for (const auto& [landmark, observation] : followed_) engine.add_observation(landmark, observation);
  }
  open_ = false;
  followed_.clear();
}

}  // namespace evbench::gp_map
