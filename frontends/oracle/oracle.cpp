#include "frontends/oracle/oracle.hpp"

#include <algorithm>

namespace evbench {
namespace {

const Registration<FrontEnd, Oracle> registration("oracle", "the tracks that a simulated source knows");

}  // namespace

Oracle::Oracle(const Options&, const FrontEndContext& context) {
  const auto tracks = context.source.true_tracks();
  if (!tracks) {
    throw InputError(
        fmt::format("{}: oracle needs a source that knows its true tracks (simulation); expected another front-end "
                    "(recorded) for this one",
                    context.place));
  }
  left_ = *tracks;
}

bool Oracle::advance(double until, std::vector<TrackObservation>& observations) {
  const auto end = std::ranges::upper_bound(left_, until, {}, &TrackObservation::t);
  observations.insert(observations.end(), left_.begin(), end);
  left_ = {end, left_.end()};
  return !left_.empty();
}

}  // namespace evbench
