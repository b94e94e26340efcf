#pragma once

#include <algorithm>

#include "core/plugin/frontend.hpp"
#include "core/plugin/source.hpp"
#include "core/testing/catch2.hpp"

namespace evbench::testing {

/// All that a front-end tells of its source, asked every `interval` [s], for at most so many observations at a time
/// where `most` is above 0. Observations are checked to lie within their batch.
inline TrackBatch all_told(FrontEnd& frontend, const Source& source, double interval = 0.01, std::size_t most = 0) {
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
    return x.track == y.track && x.t == y.t && x.pixel == y.pixel;
  });
}

}  // namespace evbench::testing
