#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "core/data/seeds.hpp"
#include "core/events/event_front_end.hpp"
#include "frontends/str/batches.hpp"
#include "frontends/str/options.hpp"

namespace evbench::str {

/// Spatiotemporal registration after Liu, Parra and Chin, CVPR 2021 (from the description; there is no public code).
/// Batches of events are registered as point clouds under a motion model. Corresponding events, chained from batch to
/// batch, are the tracks. As a model of a few parameters does not hold for all depths, the surroundings of each track
/// are registered once more, by translation. Throws InputError for a source without events.
class Str : public EventFrontEnd {
 public:
  using Options = str::Options;

  Str(const Options& options, const FrontEndContext& context);

  FeedbackNeeds needs() const override;
  void receive(const Feedback& feedback) override;

 private:
  std::vector<std::string> counts() const override;
  struct Track {
    TrackId id;
    Eigen::Vector2f ray;     ///< its position (x, y, 1)
    std::int64_t t;          ///< [µs], of the position
    Vector2 pixel;           ///< raw
    EventCloud anchor = {};  ///< events around it when it was anchored, moved to now
  };

  void take(std::span<const Event> events) override { batches_.add(events); }
  void on_tick() override;
  double complete() const override { return complete_; }
  void process(const Batch& batch);
  void go_on(const Batch& batch, const Registration& registration);
  bool go_on(Track& track, const Batch& batch, const Registration& registration);
  void replenish(const Batch& batch, const Registration& registration);
  void start_seeds(const Batch& batch, const Registration& registration);
  Eigen::Vector2f anchored(Track& track, const Matrix3& A, const Eigen::Vector2f& place, double duration);
  void observe_between(const Track& track, const Batch& batch, const Eigen::Vector2f& place, const Matrix3& A,
                       std::int64_t reference, std::int64_t until);
  void observe(Track& track, const Eigen::Vector2f& ray, std::int64_t t);
  Vector2 pixel_of(const Eigen::Vector2f& ray) const;

  Options options_;
  Seeds seeds_;
  Batches batches_;
  Registrar registrar_;
  std::vector<Track> tracks_;  ///< the older ones first
  std::optional<Matrix3> expected_;
  EventCloud early_, patch_;
  std::vector<float> early_x_, early_y_;  ///< at the reference time
  double complete_;                       ///< [s] all observations up to here have been made
  TrackId next_id_ = 0;
  std::size_t grown_ = 0, misfits_ = 0, left_ = 0, crowded_ = 0;
  std::array<std::size_t, 4> registered_{};  ///< batches by Registration::State
};

}  // namespace evbench::str
