#include "bench/pipeline/frontend_runner.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "core/support/interruption.hpp"

namespace evbench {

FrontEndRunner::FrontEndRunner(FrontEnd& frontend, const Source& source, const PipelineOptions& options,
                               FeedbackLine& feedback)
    : frontend_(frontend),
      source_(source),
      range_(source.time_range()),
      options_(options),
      feedback_(feedback),
      needs_(frontend.needs()),
      clock_(range_.from),
      until_(range_.from) {}

std::optional<TrackBatch> FrontEndRunner::next() {
  while (!begun_ || until_ < frontend_.data_end().value_or(range_.to)) {
    check_interruption();
    TrackBatch batch = exchange();
    const bool is_new = !begun_ || batch.until > until_ || !batch.ended.empty();
    begun_ = true;
    clock_ = *batch.seen;
    until_ = batch.until;
    if (!is_new) continue;
    if (needs_.any) feedback_.expect(clock_);
    return batch;
  }
  return std::nullopt;
}

FrontFacts FrontEndRunner::facts() const {
  FrontFacts facts{frontend_.waited(), seconds(), work_, data_s_, {}};
  for (const std::string& remark : source_.remarks()) facts.log.push_back("source: " + remark);
  for (const std::string& remark : frontend_.remarks()) facts.log.push_back("frontend: " + remark);
  return facts;
}

TrackBatch FrontEndRunner::exchange() {
  const double before = seconds();
  if (needs_.any) {
    for (const Feedback& feedback : feedback_.due(clock_)) watch_.time([&] { frontend_.receive(feedback); });
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
  batch.seen = batch.known_at();
  work_.push_back({*batch.seen, seconds() - before});
  frontend_s_ = seconds();
  return batch;
}

/// The end of the current interval.
double FrontEndRunner::next_time() {
  const auto end = [&] { return range_.from + static_cast<double>(exchanges_) * options_.interval; };
  while (exchanges_ == 0 || end() <= clock_) ++exchanges_;
  return std::min(end(), range_.to);
}

void FrontEndRunner::check(const TrackBatch& batch, double horizon) const {
  const auto fail = [&](const std::string& what) {
    throw std::runtime_error(
        fmt::format("the front-end's batch from {:.6f} s to {:.6f} s (requested up to {:.6f} s) {}", until_,
                    batch.until, horizon, what));
  };
  const double seen = batch.known_at();
  if (!(batch.until <= seen && seen <= horizon) || batch.until < until_ || seen < clock_ ||
      (begun_ && batch.until == until_ && seen == clock_)) {
    fail("ends at a wrong time; expected one after the last batch's end and not after the requested one");
  }
  if (!std::ranges::is_sorted(batch.observations, {}, &TrackObservation::t)) {
    fail("has observations out of time order; expected none before its predecessor");
  }
  for (const TrackObservation& z : batch.observations) {
    if (z.t <= batch.until && (z.t > until_ || (!begun_ && z.t >= until_))) continue;
    fail(fmt::format("has an observation at {:.6f} s; expected times within the batch", z.t));
  }
  if (!std::ranges::is_sorted(batch.ended, {}, &TrackEnd::t)) {
    fail("ends tracks out of time order; expected none before its predecessor");
  }
  for (const TrackEnd& ended : batch.ended) {
    if (ended.t > batch.until) fail(fmt::format("ends a track at {:.6f} s; expected a time within the batch", ended.t));
  }
}

/// Counts the batch's data, and ends all tracks after the front-end's last observation.
void FrontEndRunner::count(TrackBatch& batch) {
  in_time_order(
      batch.observations, batch.ended, [&](const TrackObservation& z) { live_.insert(z.track); },
      [&](const TrackEnd& ended) { live_.erase(ended.track); });
  if (!batch.observations.empty()) {
    if (!first_) first_ = batch.observations.front().t;
    data_s_ = batch.observations.back().t - *first_;
  }
  if (!more_) {
    for (const TrackId track : live_) batch.ended.push_back({track, batch.until});
    live_.clear();
  }
}

}  // namespace evbench
