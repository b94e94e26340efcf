// The front-end NAME for evbench: a small one to start from. It takes the true tracks of a simulated source, keeps
// every n-th observation of each, and adds noise. A tracker would read context.source.events() instead.
#include <cmath>
#include <evbench/plugin.hpp>
#include <map>

namespace {

using namespace evbench;

class ClassName : public evbench::FrontEnd {
 public:
  static constexpr bool reads_events = false;  // true, the default, for a tracker

  struct Options {
    int every = 2;
    double noise = 0.5;

    void declare(OptionSet& set) {
      set.add("every", every, "keep every n-th observation of a track").range(1);
      set.add("noise", noise, "standard deviation of the noise added to each coordinate [px]").range(0.0);
    }
  };

  ClassName(const Options& options, const FrontEndContext& context) {
    const auto tracks = context.source.true_tracks();
    if (!tracks) {
      throw InputError(context.place + ": NAME needs a source with true tracks, such as simulation");
    }
    Random random(context.seed);
    std::map<TrackId, int> seen;
    for (TrackObservation z : *tracks) {
      if (seen[z.track]++ % options.every != 0) continue;
      z.pixel += options.noise * random.normal2();
      z.noise = z.noise + options.noise;
      observations_.push_back(z);
    }
    player_ = TrackPlayer(observations_);
    remark_ = std::to_string(observations_.size()) + " of " + std::to_string(tracks->size()) + " observations kept";
  }

  // The player gives the observations and ends of known tracks up to the horizon.
  bool advance(const Horizon& horizon, TrackBatch& batch) override { return player_.advance(horizon, batch); }

  std::vector<std::string> remarks() const override { return {remark_}; }

 private:
  std::vector<TrackObservation> observations_;
  TrackPlayer player_;
  std::string remark_;
};

const Registration<evbench::FrontEnd, ClassName> registration("NAME", "template: true tracks, thinned and with noise");

}  // namespace
