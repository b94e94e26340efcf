#pragma once

#include "core/data/time_unit.hpp"
#include "core/plugin/options.hpp"
#include "core/plugin/track_player.hpp"

namespace evbench {

/// Tracks from a file (see core/data/tracks.hpp), in the source's time range. Lines out of order and duplicates are
/// corrected and reported by remarks(), as are observations outside the image and tracks of one observation. Throws
/// InputError for a file that is missing or damaged and if no observation is left.
class Recorded : public FrontEnd {
 public:
  static constexpr bool reads_events = false;

  struct Options {
    std::string tracks = {}, ends = {}, columns = {};
    TimeUnit time_unit = TimeUnit::unsaid;
    double sigma = 1.0;
    std::string outside = "drop";
    int min_track_length = 1;

    void declare(OptionSet& set);
  };

  Recorded(const Options& options, const FrontEndContext& context);

  bool advance(const Horizon& horizon, TrackBatch& batch) override { return player_.advance(horizon, batch); }
  std::vector<std::string> remarks() const override { return remarks_; }

 private:
  std::string path_;
  std::vector<TrackObservation> observations_;
  TrackPlayer player_;
  std::vector<std::string> remarks_;

  void drop_short_tracks(int min_length);
};

}  // namespace evbench
