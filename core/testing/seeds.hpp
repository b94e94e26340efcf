#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <string>
#include <vector>

#include "core/data/track.hpp"
#include "core/plugin/exchange.hpp"
#include "core/testing/catch2.hpp"

namespace evbench::testing {

/// Seeds for a front-end: the beginnings of a dozen tracks that it made before, under other ids.
class SeedFile {
 public:
  explicit SeedFile(const TrackBatch& made) {
    std::map<TrackId, TrackObservation> first;
    for (const TrackObservation& z : made.observations) {
      if (z.t < 0.4 && first.size() < 12) first.emplace(z.track, z);
    }
    for (const auto& [id, z] : first) seeds_.emplace(100 + 7 * id, z);
  }

  /// The file: each seed, and a later observation that is none.
  std::string text() const {
    std::string text;
    for (const auto& [id, z] : seeds_) {
      text += fmt::format("{0} {1} {2} {3}\n{0} {4} 1 1\n", id, z.t, z.pixel.x(), z.pixel.y(), z.t + 0.1);
    }
    return text;
  }

  /// Checks that each track begins at a seed with its id, at most 60 ms late, and that each seed has one that goes on.
  void check(const TrackBatch& tracks) const {
    std::map<TrackId, std::size_t> lengths;
    for (const TrackObservation& z : tracks.observations) {
      REQUIRE(seeds_.contains(z.track));
      if (lengths[z.track]++ > 0) continue;
      const TrackObservation& seed = seeds_.at(z.track);
      CHECK((z.pixel - seed.pixel).norm() < 1e-6);
      CHECK(z.t >= seed.t - 1e-6);
      CHECK(z.t < seed.t + 0.06);
    }
    CHECK(lengths.size() == seeds_.size());
    CHECK(std::ranges::is_sorted(tracks.observations, {}, &TrackObservation::t));
    CHECK(tracks.observations.size() > 10 * seeds_.size());
  }

 private:
  std::map<TrackId, TrackObservation> seeds_;
};

}  // namespace evbench::testing
