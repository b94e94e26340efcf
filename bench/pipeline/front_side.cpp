#include "bench/pipeline/front_side.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "core/support/interruption.hpp"

namespace evbench {

FrontSide::FrontSide(FrontEnd& frontend, const Source::TimeRange& range, const PipelineOptions& options,
                     FeedbackLine& feedback)
    : frontend_(frontend),
      range_(range),
      options_(options),
      feedback_(feedback),
      needs_(frontend.needs()),
      now_(range.from) {}

std::optional<TrackBatch> FrontSide::next() {
  check_interruption();
  if (begun_ && now_ >= range_.to) return std::nullopt;
  if (needs_.any) {
    for (const Feedback& feedback : feedback_.due(now_)) watch_.time([&] { frontend_.receive(feedback); });
  }
  const double horizon = next_time();
  TrackBatch batch;
  batch.until = horizon;
  if (more_) {
    const auto most = static_cast<std::size_t>(options_.observations);
    more_ = watch_.time([&] { return frontend_.advance({horizon, most}, batch); });
    check(batch, horizon);
    count(batch);
  }
  begun_ = true;
  now_ = batch.until;
  if (needs_.any) feedback_.expect(now_);
  return batch;
}

/// The end of the interval that is being gone through.
double FrontSide::next_time() {
  const auto end = [&] { return range_.from + static_cast<double>(exchanges_) * options_.interval; };
  while (exchanges_ == 0 || end() <= now_) ++exchanges_;
  return std::min(end(), range_.to);
}

void FrontSide::check(const TrackBatch& batch, double horizon) const {
  const auto fail = [&](const std::string& what) {
    throw std::runtime_error(
        fmt::format("the front-end's batch from {:.6f} s to {:.6f} s (up to {:.6f} s were asked for) {}", now_,
                    batch.until, horizon, what));
  };
  if (!(batch.until <= horizon) || batch.until < now_ || (begun_ && batch.until == now_)) {
    fail("ends at a wrong time; expected one after the last batch's end and not after what was asked for");
  }
  if (!std::ranges::is_sorted(batch.observations, {}, &TrackObservation::t)) {
    fail("has observations out of time order; expected each not before the one in front of it");
  }
  for (const TrackObservation& z : batch.observations) {
    if (z.t <= batch.until && (z.t > now_ || (!begun_ && z.t >= now_))) continue;
    fail(fmt::format("has an observation at {:.6f} s; expected times within the batch", z.t));
  }
  for (const TrackEnd& ended : batch.ended) {
    if (ended.t > batch.until) fail(fmt::format("ends a track at {:.6f} s, after itself", ended.t));
  }
}

/// What was given, and, when nothing more comes, that all tracks have ended.
void FrontSide::count(TrackBatch& batch) {
  for (const TrackObservation& z : batch.observations) live_.insert(z.track);
  for (const TrackEnd& ended : batch.ended) live_.erase(ended.track);
  if (!batch.observations.empty()) {
    if (!first_) first_ = batch.observations.front().t;
    last_ = batch.observations.back().t;
  }
  if (more_) return;
  for (const TrackId track : live_) batch.ended.push_back({track, batch.until});
  live_.clear();
}

}  // namespace evbench
