#pragma once

#include <array>
#include <string>
#include <vector>

#include "core/data/seeds.hpp"
#include "core/events/event_front_end.hpp"
#include "core/events/recent_events.hpp"
#include "frontends/poisson/options.hpp"
#include "frontends/poisson/tracker.hpp"

namespace evbench::poisson {

/// Tracks features asynchronously by the likelihood of events (Tracker): an observation at its own time as soon as a
/// feature has moved by a pixel, with a standard deviation that follows from what its events tell. Detects new features
/// where there are too few. Uses only outliers of the back-end's feedback.
class Poisson : public EventFrontEnd {
 public:
  using Options = poisson::Options;

  /// Throws InputError for a source without events.
  Poisson(const Options& options, const FrontEndContext& context);

  FeedbackNeeds needs() const override;
  void receive(const Feedback& feedback) override;

 private:
  struct Track {
    TrackId id;
    Tracker tracker;
    int settling;            ///< observations that are left out yet
    double reported;         ///< [s] time of the newest observation
    double corrected = 0.0;  ///< [s] of the newest correction that is known here
    double odometer = 0.0;   ///< value of odometer_ then [px]
  };
  /// Why a track ends.
  enum class End { border, deviation, starvation, crowding, outlier };

  std::vector<std::string> counts() const override;
  void take(std::span<const Event> events) override;
  void on_tick() override;
  double complete() const override { return clock_ - options_.delay; }

  void process(std::span<const Event> events);
  void report(Track& track, const Tracker::Observation& observation);
  void expect_neighbours();
  void end_trackers();
  std::optional<End> reason_to_end(const Track& track, std::span<const Track> older) const;
  void end(const Track& track, End why);
  void replenish();
  bool begin(TrackId id, const Vector2& pixel, std::optional<double> at);
  std::vector<Event> events_around(const Vector2& pixel) const;

  Options options_;
  Seeds seeds_;
  RecentEvents recent_;
  std::vector<Track> tracks_;                                    ///< oldest first
  std::vector<std::vector<Tracker::Observation>> observations_;  ///< by track, of the newest events
  double latest_;                                                ///< [s] time of the newest event
  double detected_;                                              ///< [s] when features were last detected
  double odometer_ = 0.0;  ///< path length of the image: by the trackers' median velocity [px]
  TrackId next_id_ = 0;
  std::size_t begun_ = 0;
  std::array<std::size_t, 5> ended_{};  ///< by End
};

}  // namespace evbench::poisson
