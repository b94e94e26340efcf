#pragma once

#include <functional>
#include <string>
#include <vector>

#include "core/plugin/frontend.hpp"
#include "core/plugin/source.hpp"
#include "core/plugin/track_player.hpp"
#include "core/simulation/track_simulator.hpp"

namespace evbench::battery {

/// What the simulated sequence of a check is like.
struct SequenceOptions {
  double duration = 3.0;  ///< [s]
  double range = 0.0;     ///< [s] end of the time range; 0: duration
  std::string motion = R"({"kind": "robot_arm", "period": 3})";
  std::string tracks = R"({"alive": 50, "rate": [50, 100], "lifetime": [2, 5]})";
  /// Which observations there are; may change them.
  std::function<bool(TrackObservation&)> keep = [](TrackObservation&) { return true; };
};

/// A camera that moves before a volume of points, and the tracks that it would see.
class TrackSource : public Source {
 public:
  explicit TrackSource(const SequenceOptions& options);

  const Camera& camera() const override { return camera_; }
  TimeRange time_range() const override { return {0.0, range_}; }
  const PoseTrajectory& ground_truth() const override { return ground_truth_; }
  std::optional<std::span<const TrackObservation>> true_tracks() const override { return observations_; }

 private:
  double range_;
  Camera camera_;
  PoseTrajectory ground_truth_;
  std::vector<TrackObservation> observations_;
};

/// Hands on a source's tracks. As a listener it takes all feedback, keeps it, and lets it change what it tells.
class TrackFrontEnd : public FrontEnd {
 public:
  explicit TrackFrontEnd(const Source& source, bool listens = false)
      : player_(*source.true_tracks()), listens_(listens) {}

  bool advance(const Horizon& horizon, TrackBatch& batch) override;
  FeedbackNeeds needs() const override { return {listens_, listens_, listens_}; }
  void receive(const Feedback& feedback) override;

  const std::vector<Feedback>& heard() const { return heard_; }

 private:
  TrackPlayer player_;
  bool listens_;
  std::vector<Feedback> heard_;
};

}  // namespace evbench::battery
