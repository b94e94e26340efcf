#pragma once

#include <functional>
#include <string>
#include <vector>

#include "core/plugin/frontend.hpp"
#include "core/plugin/source.hpp"
#include "core/plugin/track_player.hpp"
#include "core/simulation/track_simulator.hpp"

namespace evbench::battery {

/// Options of the simulated sequence of a check.
struct SequenceOptions {
  double duration = 3.0;  ///< [s]
  double range = 0.0;     ///< [s] end of the time range; 0: duration
  std::string motion = R"({"kind": "robot_arm", "period": 3})";
  std::string tracks = R"({"alive": 50, "rate": [50, 100], "lifetime": [2, 5]})";
  /// Whether to keep an observation; may change it.
  std::function<bool(TrackObservation&)> keep = [](TrackObservation&) { return true; };
};

/// A camera that moves in front of a volume of points, and the simulated tracks of these.
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

/// Replays a source's tracks. If it listens, it keeps all feedback and shifts its observations by it.
class TrackFrontEnd : public FrontEnd {
 public:
  explicit TrackFrontEnd(const Source& source, bool listens = false)
      : player_(*source.true_tracks()), listens_(listens) {}

  bool advance(const Horizon& horizon, TrackBatch& batch) override;
  FeedbackNeeds needs() const override { return {listens_, listens_, listens_}; }
  void receive(const Feedback& feedback) override;

  const std::vector<Feedback>& received() const { return received_; }

 private:
  TrackPlayer player_;
  bool listens_;
  std::vector<Feedback> received_;
};

}  // namespace evbench::battery
