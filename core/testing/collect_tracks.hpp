#pragma once

#include <algorithm>

#include "core/plugin/frontend.hpp"
#include "core/plugin/source.hpp"
#include "core/testing/catch2.hpp"

namespace evbench::testing {

/// Collects all tracks of a front-end, with an exchange every `interval` [s]; with `most` > 0, at most that many
/// observations per exchange. Checks that the observations are within their batch.
inline TrackBatch collect_tracks(FrontEnd& frontend, const Source& source, double interval = 0.01,
                                 std::size_t most = 0) {
  const double to = source.time_range().to;
  TrackBatch all, batch;
  all.until = 0.0;
  for (int k = 1; all.until < to;) {
    const double horizon = std::min(to, interval * k);
    frontend.advance({horizon, most}, batch);
    REQUIRE(batch.until >= all.until);
    for (const TrackObservation& z : batch.observations) {
      CHECK((z.t > all.until && z.t <= batch.until));
      all.observations.push_back(z);
    }
    all.ended.insert(all.ended.end(), batch.ended.begin(), batch.ended.end());
    all.until = batch.until;
    if (batch.known_at() >= horizon) ++k;
  }
  return all;
}

/// Are the observations the same, bit by bit?
inline bool same(const TrackBatch& a, const TrackBatch& b) {
  return std::ranges::equal(a.observations, b.observations, [](const TrackObservation& x, const TrackObservation& y) {
    return x.track == y.track && x.t == y.t && x.pixel == y.pixel && x.noise == y.noise;
  });
}

}  // namespace evbench::testing
