#include <cmath>
#include <set>

#include "bench/pipeline/pipeline.hpp"
#include "core/geometry/so3.hpp"
#include "core/plugin/track_player.hpp"
#include "core/plugin/tracking_monitor.hpp"
#include "core/testing/catch2.hpp"

using namespace evbench;

namespace {

constexpr double kGap = 2.0, kAgain = 4.0, kEnd = 7.0;  // [s] tracks are observed until kGap and from kAgain to kEnd

/// A camera that moves to the right at 0.1 m/s.
SE3 truth(double t) { return {Eigen::Quaterniond::Identity(), {0.1 * t, 0.0, 0.0}}; }

/// Landmarks about 2 m in front of it.
Vector3 point_of(TrackId track) {
  const auto i = static_cast<double>(track);
  return {0.3 + 0.9 * std::sin(2.1 * i), 0.6 * std::sin(3.7 * i + 1.0), 2.0 + 0.5 * std::sin(5.3 * i)};
}

class View : public Source {
 public:
  View() {
    camera_.width = 240;
    camera_.height = 180;
    camera_.pinhole = {200.0, 200.0, 119.5, 89.5};
  }
  const Camera& camera() const override { return camera_; }
  TimeRange time_range() const override { return {0.0, kEnd}; }
  const PoseTrajectory& ground_truth() const override { return truth_; }

 private:
  Camera camera_;
  PoseTrajectory truth_;
};

/// Twenty tracks before the gap, and twenty after it of which `common` are the same. Keeps the feedback.
class Tracks : public FrontEnd {
 public:
  explicit Tracks(TrackId common) : observations_(made(common)), player_(observations_, ends_at_gap()) {}
  bool advance(const Horizon& horizon, TrackBatch& batch) override { return player_.advance(horizon, batch); }
  FeedbackNeeds needs() const override { return {true, true, true}; }
  void receive(const Feedback& feedback) override { received.push_back(feedback); }

  std::vector<Feedback> received;

 private:
  static std::vector<TrackEnd> ends_at_gap() {
    std::vector<TrackEnd> ends;
    for (TrackId track = 0; track < 20; ++track) ends.push_back({track, kGap + 0.002});
    return ends;
  }
  static std::vector<TrackObservation> made(TrackId common) {
    const PinholeCamera camera = View().camera().pinhole;
    std::vector<TrackObservation> result;
    for (int k = 0; 0.001 * k <= kEnd; ++k) {
      const double t = 0.001 * k;
      if (t > kGap && t < kAgain) continue;
      const TrackId track = k % 20 + (t > kGap ? 20 - common : 0);
      result.push_back({track, t, camera.project(truth(t).inverse() * point_of(track)), 1.0});
    }
    return result;
  }
  std::vector<TrackObservation> observations_;
  TrackPlayer player_;
};

/// Publishes the true poses in a world frame and scale of its own, and maps all observed tracks.
class Surveyor : public BackEnd {
 public:
  Surveyor(const BackEndContext& context, const Similarity& world)
      : context_(context), monitor_(context.patience), to_own_(world) {}

  void advance(const UndistortedBatch& batch) override {
    for (const UndistortedObservation& z : batch.observations) seen_.insert(z.track);
    if (!batch.observations.empty()) {
      newest_ = batch.observations.back().t;
      poses_.push_back({newest_, to_own_ * truth(newest_)});
      context_.publish({poses_.back(), {}, body_velocity()});
    }
    using Support = TrackingMonitor::Support;
    const bool sees = batch.until - newest_ < 0.05;
    if (!poses_.empty()) monitor_.observe(until_, batch.until, sees ? Support::full : Support::none, "nothing is seen");
    until_ = batch.until;
  }
  BackEndFeedback feedback(const FeedbackNeeds&) override {
    BackEndFeedback result{monitor_.state(), {}, {}, {}, {}};
    if (poses_.empty()) return result;
    result.newest = ControlState{newest_, poses_.back().T, body_velocity()};
    result.covariance = Matrix12::Identity();
    for (const Landmark& landmark : map()) {
      const Vector3 seen = poses_.back().T.inverse() * landmark.position;
      result.expected.push_back(
          {landmark.track, landmark.position, context_.camera.project(seen), Matrix2::Identity()});
    }
    return result;
  }
  void finish() override {}
  Status status() const override { return monitor_.status(); }
  PoseTrajectory trajectory() const override {
    std::vector<StampedPose> poses = poses_;
    return PoseTrajectory(std::move(poses));
  }
  std::vector<Landmark> map() const override {
    std::vector<Landmark> result;
    for (const TrackId track : seen_) result.push_back({track, to_own_ * point_of(track)});
    return result;
  }

 private:
  Vector6 body_velocity() const { return (Vector6() << 0, 0, 0, 0.1 * to_own_.scale, 0, 0).finished(); }

  BackEndContext context_;
  TrackingMonitor monitor_;
  Similarity to_own_;
  std::vector<StampedPose> poses_;
  std::set<TrackId> seen_;
  double until_ = 0.0, newest_ = 0.0;
};

/// Each back-end has another world frame and scale; the first one's is the true one.
MakeBackEnd surveyors() {
  return [made = 0](const BackEndContext& context) mutable {
    const double i = made++;
    return std::make_unique<Surveyor>(
        context, Similarity{1.0 + i, {so3::exp({0.2 * i, -0.4 * i, 0.1 * i}), {3.0 * i, -i, 0.5 * i}}});
  };
}

RunResult run(Tracks& tracks, bool relocalise = true) {
  PipelineOptions options;
  options.relocalise = relocalise;
  return run_pipeline(View(), tracks, surveyors(), {}, options, 0.0);
}

void check_true(const PoseTrajectory& trajectory, double from) {
  CHECK(trajectory.end() > kEnd - 0.1);
  for (const StampedPose& pose : trajectory.poses()) {
    if (pose.t >= from) CHECK((pose.T.p - truth(pose.t).p).norm() < 1e-4);
  }
}

}  // namespace

TEST_CASE("After a loss the run continues in the same world if earlier landmarks are observed again") {
  Tracks tracks(12);
  const RunResult result = run(tracks);
  CHECK(result.status.state == RunState::degraded);
  CHECK(result.status.time == Approx(kGap).margin(0.1));
  CHECK(result.status.reason.find("nothing is seen") != std::string::npos);
  REQUIRE(result.segments.size() == 1);
  const TrajectorySegment& segment = result.segments.front();
  check_true(segment.final_trajectory, 0.0);
  check_true(segment.causal_trajectory, 0.0);
  const auto in_gap = [](const StampedPose& pose) { return pose.t > kGap + 0.1 && pose.t < kAgain; };
  CHECK(std::ranges::none_of(segment.final_trajectory.poses(), in_gap));
  CHECK(segment.map.size() == 28);
  for (const Landmark& landmark : segment.map) CHECK((landmark.position - point_of(landmark.track)).norm() < 1e-4);
  for (const CausalPose& pose : segment.published) CHECK(pose.velocity->tail<3>().norm() == Approx(0.1).epsilon(1e-3));
  CHECK(std::ranges::any_of(result.log, [](const std::string& line) {
    return line.find("relocalised in the earlier world, by ") != std::string::npos;
  }));
}

TEST_CASE("Once the camera is relocalised, feedback is in the earlier world and predicts its other landmarks") {
  Tracks tracks(12);
  run(tracks);
  const auto in = [&](std::size_t world) {
    return std::ranges::count_if(tracks.received, [&](const Feedback& f) { return f.newest && f.world == world; });
  };
  CHECK(in(0) > 100);
  CHECK(in(1) > 0);  // until it is relocalised
  const Feedback& last = tracks.received.back();
  CHECK(last.world == 0);
  REQUIRE(last.newest);
  CHECK((last.newest->T.p - truth(last.newest->t).p).norm() < 1e-4);
  CHECK(last.newest->velocity.tail<3>().norm() == Approx(0.1).epsilon(1e-3));
  REQUIRE(last.covariance);
  CHECK((*last.covariance)(3, 3) == Approx(0.25).epsilon(1e-3));
  CHECK((*last.covariance)(0, 0) == 1.0);
  CHECK((*last.covariance)(0, 9) == 0.0);
  std::set<TrackId> expected;
  for (const ExpectedFeature& feature : last.expected) {
    CHECK(expected.insert(feature.track).second);
    CHECK((feature.position - point_of(feature.track)).norm() < 1e-3);
    const Vector3 seen = truth(last.t).inverse() * point_of(feature.track);
    CHECK((feature.pixel - View().camera().pinhole.project(seen)).norm() < 0.5);
  }
  const auto of_before = [](TrackId track) { return track < 8; };
  CHECK(std::ranges::count_if(expected, of_before) >= 4);
}

TEST_CASE("After a loss the trajectory has segments if too few earlier landmarks are observed again, or by option") {
  Tracks few_common(5), switched_off(12);
  for (const RunResult& result : {run(few_common), run(switched_off, false)}) {
    CHECK(result.status.state == RunState::lost);
    REQUIRE(result.segments.size() == 2);
    CHECK(result.segments[0].final_trajectory.end() < kAgain);
    CHECK(result.segments[1].final_trajectory.start() >= kAgain);
    CHECK(result.segments[1].map.size() == 20);
  }
  CHECK(few_common.received.back().world == 1);
}
