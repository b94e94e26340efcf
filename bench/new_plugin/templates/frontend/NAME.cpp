// The front-end NAME for evbench, all of it: a small one to start from. It takes the tracks that a simulated source
// knows, hands on every n-th observation of each, and adds noise. A tracker would read context.source.events() instead.
#include <cmath>
#include <map>

#include "core/plugin/registration.hpp"
#include "core/plugin/track_player.hpp"
#include "core/simulation/random.hpp"
#include "core/support/error.hpp"

namespace {

using namespace evbench;

class ClassName : public evbench::FrontEnd {
 public:
  static constexpr bool reads_events = false;  // a tracker's is true, or left out

  struct Options {
    int every = 2;
    double noise = 0.5;

    void declare(OptionSet& set) {
      set.add("every", every, "of a track's observations the first of every so many is handed on").range(1);
      set.add("noise", noise, "standard deviation of what is added to each coordinate [px]").range(0.0);
    }
  };

  ClassName(const Options& options, const FrontEndContext& context) {
    const auto tracks = context.source.true_tracks();
    if (!tracks) {
      throw InputError(context.place + ": NAME needs a source that knows its true tracks, such as simulation");
    }
    Random random(context.seed);
    std::map<TrackId, int> seen;
    for (TrackObservation z : *tracks) {
      if (seen[z.track]++ % options.every != 0) continue;
      z.pixel += options.noise * random.normal2();
      z.sigma = std::hypot(z.sigma, options.noise);
      observations_.push_back(z);
    }
    player_ = TrackPlayer(observations_);
    remark_ =
        std::to_string(observations_.size()) + " of " + std::to_string(tracks->size()) + " observations handed on";
  }

  // Observations up to the horizon and the tracks that end there: the player knows how for tracks known beforehand.
  bool advance(const Horizon& horizon, TrackBatch& batch) override { return player_.advance(horizon, batch); }

  std::vector<std::string> remarks() const override { return {remark_}; }

 private:
  std::vector<TrackObservation> observations_;
  TrackPlayer player_;
  std::string remark_;
};

const Registration<evbench::FrontEnd, ClassName> registration("NAME", "true tracks, thinned and made noisy, a start");

}  // namespace
