#include "core/simulation/track_wander.hpp"

#include <cmath>
#include <map>

namespace evbench {

void add_wander(std::span<TrackObservation> observations, double deviation, double time, Random random) {
  struct Offset {
    double t;
    Vector2 value;
  };
  std::map<TrackId, Offset> offsets;
  const auto normal = [&] { return random.normal2(); };
  for (TrackObservation& z : observations) {
    const auto [at, begins] = offsets.try_emplace(z.track, Offset{z.t, Vector2::Zero()});
    Offset& now = at->second;
    const double kept = begins ? 0.0 : std::exp((now.t - z.t) / time);
    now = {z.t, kept * now.value + deviation * std::sqrt(1.0 - kept * kept) * normal()};
    z.pixel += now.value;
    z.noise = z.noise + deviation;
  }
}

}  // namespace evbench
