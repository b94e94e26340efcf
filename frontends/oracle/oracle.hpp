#pragma once

#include "core/plugin/options.hpp"
#include "core/plugin/track_player.hpp"

namespace evbench {

/// Passes on the tracks that the source itself knows: association without error. Throws InputError for a source without
/// true tracks, such as a recording.
class Oracle : public FrontEnd {
 public:
  static constexpr bool reads_events = false;

  struct Options {
    void declare(OptionSet&) {}
  };

  Oracle(const Options& options, const FrontEndContext& context);

  bool advance(const Horizon& horizon, TrackBatch& batch) override { return player_.advance(horizon, batch); }

 private:
  TrackPlayer player_;
};

}  // namespace evbench
