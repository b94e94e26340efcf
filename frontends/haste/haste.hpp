#pragma once

#include <array>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/data/seeds.hpp"
#include "core/events/event_front_end.hpp"
#include "frontends/haste/guidance.hpp"
#include "frontends/haste/lost_landmarks.hpp"
#include "frontends/haste/options.hpp"
#include "frontends/haste/recent_events.hpp"
#include "frontends/haste/tracking/score_noise.hpp"
#include "frontends/haste/tracking/tracker_set.hpp"

namespace evbench::haste {

/// Tracks features directly in the events, each one asynchronously by hypotheses about its motion (Alzugaray and Chli,
/// 3DV 2019 and BMVC 2020). Detects new features where there are too few, and searches for lost landmarks where the
/// back-end expects them. The front-end of Algorithm 1 of Liu et al., ICRA 2022. Throws InputError for a source without
/// events.
class Haste : public EventFrontEnd {
 public:
  using Options = haste::Options;

  Haste(const Options& options, const FrontEndContext& context);

  FeedbackNeeds needs() const override;
  void receive(const Feedback& feedback) override;

 private:
  std::vector<std::string> counts() const override;

  static constexpr double kInfinity = std::numeric_limits<double>::infinity();

  /// The feature track that a tracker makes observations of, and its bookkeeping.
  struct Track {
    TrackId id;
    double odometer;                     ///< value of odometer_ when the tracker last changed its state [px]
    Vector2 pixel = Vector2::Zero();     ///< newest position [px]
    int probation = 0;                   ///< changes of state until a re-acquired landmark's track goes on
    bool displaced = false;              ///< re-acquired off its expected position; not back there yet
    double reported = -kInfinity;        ///< [s] time of its last observation
    double found = -kInfinity;           ///< [s] when the tracker was last confirmed to follow something
    Vector2 from = pixel;                ///< its position then [px]
    double way = 0.0;                    ///< path length since then [px]
    Eigen::AlignedBox2d visited{pixel};  ///< bounding box of its positions since then
    int looked_at = 0;                   ///< number of comparisons with lost landmarks
    std::int64_t doubted = -1;  ///< its tracker's event count when the sensor fell silent; −1: no check pending
  };

  /// Why a track ends.
  enum class End { border, spread, edge, starvation, crowding, veto, outlier, erratic, silence, recognised };

  void take(std::span<const Event> events) override;
  void on_tick() override;
  double complete() const override { return clock_ - options_.delay; }
  void observe(const Change& change);
  bool is_as_expected(TrackId track, const Vector2& pixel, double t) const;
  void correct_guidance();
  void replenish();
  void process(std::span<const Event> events);
  void start_seeds(double t);
  void begin(Tracker tracker, const Track& track);

  // track_life.cpp
  void doubt_trackers();
  void end_mismatched();
  void end_erratic();
  void end_trackers();
  void veto_strays();
  void end(std::int64_t tracker, End why);

  // reacquisition.cpp
  void remember(const Track& track, const Tracker& tracker);
  void reacquire();
  void reacquire_displaced();
  void recognise();
  LostLandmarks::Tracked tracked() const;

  Options options_;
  Seeds seeds_;
  ScoreNoise noise_;
  RecentEvents recent_;
  TrackerSet trackers_;
  std::map<std::int64_t, Track> tracks_;  ///< by tracker
  Guidance guidance_;
  LostLandmarks lost_;
  std::vector<Change> changes_;  ///< of the current events
  double looked_;                ///< [s] when landmarks and features were last searched for in new events
  double detected_;              ///< [s] when features were last detected
  double last_event_;            ///< [s]
  double odometer_ = 0.0;        ///< path length of the image: the trackers' mean [px]
  TrackId next_id_ = 0;
  std::array<std::size_t, static_cast<std::size_t>(End::recognised) + 1> ended_{};  ///< by End
  struct Finds {
    std::size_t found = 0, went_on = 0;
  } by_template_;
  std::size_t begun_ = 0, begun_displaced_ = 0, late_ = 0;
};

}  // namespace evbench::haste
