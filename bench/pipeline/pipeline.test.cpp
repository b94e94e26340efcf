#include "bench/pipeline/pipeline.hpp"

#include <atomic>
#include <cmath>
#include <stdexcept>
#include <thread>

#include "core/plugin/track_player.hpp"
#include "core/plugin/tracking_monitor.hpp"
#include "core/testing/catch2.hpp"

using namespace evbench;
using Catch::Matchers::ContainsSubstring;

namespace {

class EmptySource : public Source {
 public:
  explicit EmptySource(double to) : range_{0.0, to} {
    camera_.width = 240;
    camera_.height = 180;
    camera_.pinhole = {200.0, 200.0, 119.5, 89.5};
    camera_.distortion = DistortionModel::radial_tangential;
    camera_.coefficients << -0.3, 0.1, 0.001, 0.002, 0.0;
  }
  const Camera& camera() const override { return camera_; }
  TimeRange time_range() const override { return range_; }
  const PoseTrajectory& ground_truth() const override { return truth_; }

 private:
  Camera camera_;
  TimeRange range_;
  PoseTrajectory truth_;
};

/// Ten tracks at 100 Hz in each span [from, to].
std::vector<TrackObservation> tracks(const std::vector<std::pair<double, double>>& spans) {
  std::vector<TrackObservation> result;
  TrackId first = 0;
  for (const auto& [from, to] : spans) {
    for (int i = 0; from + 0.001 * i <= to; ++i) {
      result.push_back({first + i % 10, from + 0.001 * i, Vector2(60.0 + i % 100, 80.0), 1.0});
    }
    first += 10;
  }
  return result;
}

/// Replays given tracks and records the feedback that it gets. The feedback shifts its observations.
class Listener : public FrontEnd {
 public:
  Listener(std::vector<TrackObservation> observations, FeedbackNeeds needs)
      : observations_(std::move(observations)), player_(observations_), needs_(needs) {}

  bool advance(const Horizon& horizon, TrackBatch& batch) override {
    const bool more = player_.advance(horizon, batch);
    for (TrackObservation& z : batch.observations) z.pixel.x() += shift_;
    until_ = batch.until;
    ++exchanges;
    return more;
  }
  FeedbackNeeds needs() const override { return needs_; }
  void receive(const Feedback& feedback) override {
    received.push_back({feedback.t, until_});
    states.push_back(feedback.state);
    if (feedback.newest) shift_ = 0.1 * std::sin(1000.0 * feedback.newest->T.p.x());
  }

  int exchanges = 0;
  std::vector<std::pair<double, double>> received;  ///< time of the feedback, data time at which it arrived
  std::vector<TrackingState> states;

 private:
  std::vector<TrackObservation> observations_;
  TrackPlayer player_;
  FeedbackNeeds needs_;
  double shift_ = 0.0, until_ = 0.0;
};

/// Publishes the running mean of the observed pixels as its position; lost after the patience without observations.
class Mean : public BackEnd {
 public:
  explicit Mean(const BackEndContext& context) : context_(context), monitor_(context.patience) {}

  void advance(const UndistortedBatch& batch) override {
    for (const UndistortedObservation& z : batch.observations) {
      sum_ = 0.99 * sum_ + 0.01 * z.pixel;
      live_ = true;
    }
    if (!batch.observations.empty()) {
      poses_.push_back({batch.observations.back().t, {Eigen::Quaterniond::Identity(), {sum_.x(), sum_.y(), 0.0}}});
      context_.publish({poses_.back()});
      silent_since_ = batch.until;
    }
    using Support = TrackingMonitor::Support;
    const bool seen = batch.until - silent_since_ < 0.05;
    if (live_) monitor_.observe(until_, batch.until, seen ? Support::full : Support::none, "nothing is seen");
    until_ = batch.until;
  }
  BackEndFeedback feedback(const FeedbackNeeds& needs) override {
    BackEndFeedback result{monitor_.state(), {}, {}, {}, {}};
    if (!poses_.empty()) result.newest = ControlState{poses_.back().t, poses_.back().T, Vector6::Zero()};
    if (needs.expected) result.expected.push_back({7, {0, 0, 1}, sum_, Matrix2::Identity()});
    return result;
  }
  void finish() override {
    if (!live_) monitor_.fail(until_, "nothing was seen");
  }
  Status status() const override { return monitor_.status(); }
  PoseTrajectory trajectory() const override {
    std::vector<StampedPose> seen = poses_;
    return PoseTrajectory(std::move(seen));
  }
  std::vector<Landmark> map() const override { return {}; }

 private:
  BackEndContext context_;
  TrackingMonitor monitor_;
  std::vector<StampedPose> poses_;
  Vector2 sum_ = Vector2::Zero();
  bool live_ = false;
  double until_ = 0.0, silent_since_ = 0.0;
};

const MakeBackEnd kMean = [](const BackEndContext& context) { return std::make_unique<Mean>(context); };

RunResult run(FrontEnd& frontend, double to, const PipelineOptions& options = {}, const MakeBackEnd& make = kMean) {
  return run_pipeline(EmptySource(to), frontend, make, {}, options, 0.0);
}

bool same(const PoseTrajectory& a, const PoseTrajectory& b) {
  return std::ranges::equal(a.poses(), b.poses(), [](const StampedPose& x, const StampedPose& y) {
    return x.t == y.t && x.T.p == y.T.p && x.T.q.coeffs() == y.T.q.coeffs();
  });
}

}  // namespace

TEST_CASE("A run reaches the end of its range, is lost without tracks, and counts the time of the data alone") {
  Listener frontend(tracks({{0.0, 3.0}}), {});
  const RunResult result = run(frontend, 30.0);
  CHECK(result.status.state == RunState::lost);
  CHECK(result.status.time == Approx(3.0).margin(0.1));
  CHECK(result.data_s == Approx(3.0).margin(0.01));
  REQUIRE(result.segments.size() == 1);
  CHECK(result.segments[0].final_trajectory.end() == Approx(3.0).margin(0.01));
  CHECK(result.times.frontend > 0.0);
  CHECK(result.times.backend > 0.0);
  CHECK(result.times.total >= result.times.frontend + result.times.backend);
}

TEST_CASE("Sequential and concurrent runs give identical results, whatever the feedback does") {
  for (const double latency : {0.0, 0.01, 0.035}) {
    for (const int observations : {0, 7}) {
      CAPTURE(latency, observations);
      PipelineOptions options;
      options.latency = latency;
      options.observations = observations;
      Listener one(tracks({{0.0, 2.0}}), {true, true, true}), two(tracks({{0.0, 2.0}}), {true, true, true});
      const RunResult sequential = run(one, 2.5, options);
      options.mode = "concurrent";
      const RunResult concurrent = run(two, 2.5, options);
      CHECK(sequential.tracks_sha256 == concurrent.tracks_sha256);
      CHECK(same(sequential.segments.at(0).final_trajectory, concurrent.segments.at(0).final_trajectory));
      CHECK(same(sequential.segments.at(0).causal_trajectory, concurrent.segments.at(0).causal_trajectory));
      CHECK(one.received == two.received);
      CHECK(one.received.size() > 100);
    }
  }
}

namespace {

/// Gives the observations of a time only after it has processed the data up to 30 ms later.
class LateListener : public Listener {
 public:
  static constexpr double kDelay = 0.03;
  using Listener::Listener;

  bool advance(const Horizon& horizon, TrackBatch& batch) override {
    const double end = 1.0;
    const Horizon earlier{horizon.t < end ? std::max(0.0, horizon.t - kDelay) : end, 0};
    Listener::advance(earlier, batch);
    batch.seen = horizon.t;
    return true;
  }
};

}  // namespace

TEST_CASE("Poses from delayed observations are known late, and feedback waits for it, in one thread and in two") {
  PipelineOptions options;
  LateListener one(tracks({{0.0, 1.0}}), {true, false, false}), two(tracks({{0.0, 1.0}}), {true, false, false});
  const RunResult sequential = run(one, 1.0, options);
  options.mode = "concurrent";
  const RunResult concurrent = run(two, 1.0, options);
  CHECK(sequential.tracks_sha256 == concurrent.tracks_sha256);
  CHECK(one.received == two.received);
  REQUIRE(sequential.segments.size() == 1);
  const auto& published = sequential.segments[0].published;
  REQUIRE(published.size() > 50);
  for (std::size_t i = 1; i + 4 < published.size(); ++i) {  // without those at the ends
    const CausalPose& pose = published[i];
    CHECK(*pose.known_at == Approx(pose.t + LateListener::kDelay).margin(0.0011));  // a millisecond per pose
  }
  CHECK(published.back().t == Approx(1.0));
  CHECK(sequential.observations == tracks({{0.0, 1.0}}).size());
}

TEST_CASE("The front-end's delay is added to the known_at that a back-end states") {
  class Exact : public BackEnd {
   public:
    explicit Exact(const BackEndContext& context) : mean_(quiet(context)), context_(context) {}
    void advance(const UndistortedBatch& batch) override {
      mean_.advance(batch);
      for (const UndistortedObservation& z : batch.observations) context_.publish({{z.t, {}}, z.t, {}});
    }
    BackEndFeedback feedback(const FeedbackNeeds& needs) override { return mean_.feedback(needs); }
    void finish() override { mean_.finish(); }
    Status status() const override { return mean_.status(); }
    PoseTrajectory trajectory() const override { return mean_.trajectory(); }
    std::vector<Landmark> map() const override { return {}; }

   private:
    static BackEndContext quiet(BackEndContext context) {
      context.publish = [](const CausalPose&) {};
      return context;
    }
    Mean mean_;
    BackEndContext context_;
  };
  const auto make = [](const BackEndContext& context) { return std::make_unique<Exact>(context); };
  LateListener late(tracks({{0.0, 1.0}}), {});
  const RunResult result = run(late, 1.0, {}, make);
  REQUIRE(result.segments.size() == 1);
  const auto& published = result.segments[0].published;
  REQUIRE(published.size() > 500);
  for (const CausalPose& pose : published) {
    if (pose.t < 0.05 || pose.t > 0.9) continue;
    CHECK(*pose.known_at == Approx(pose.t + LateListener::kDelay).margin(1e-9));
  }
  CHECK(std::ranges::is_sorted(published, {}, [](const CausalPose& pose) { return *pose.known_at; }));

  Listener prompt(tracks({{0.0, 1.0}}), {});
  const RunResult at_once = run(prompt, 1.0, {}, make);
  REQUIRE(at_once.segments.size() == 1);
  for (const CausalPose& pose : at_once.segments[0].published) CHECK(*pose.known_at == pose.t);
}

TEST_CASE("Feedback reaches the front-end after the latency in data time, in order and only once") {
  PipelineOptions options;
  options.latency = 0.025;
  Listener frontend(tracks({{0.0, 1.0}}), {true, false, false});
  run(frontend, 1.0, options);
  double before = 0.0;
  for (const auto& [t, now] : frontend.received) {
    CHECK(t > before);
    CHECK(now >= t + 0.025 - 1e-9);
    CHECK(now < t + 0.025 + 0.01 + 1e-9);
    before = t;
  }
  CHECK(frontend.received.size() == 96);  // the last exchange begins at 0.99 s: what was known up to 0.96 s
}

TEST_CASE("A front-end that needs no feedback gets none") {
  Listener frontend(tracks({{0.0, 1.0}}), {});
  run(frontend, 1.0);
  CHECK(frontend.received.empty());
}

TEST_CASE("Feedback has raw pixels and the tracking state") {
  class Sees : public Listener {
   public:
    using Listener::Listener;
    void receive(const Feedback& feedback) override {
      Listener::receive(feedback);
      if (!feedback.expected.empty()) pixel = feedback.expected.back().pixel;
    }
    Vector2 pixel;
  };
  std::vector<TrackObservation> one;
  for (int i = 0; i < 3000; ++i) one.push_back({i % 10, 0.001 * i, Vector2(30.0, 40.0), 1.0});
  Sees frontend(one, {true, false, true});
  run(frontend, 3.0);
  CHECK(frontend.pixel.x() == Approx(30.0).margin(0.2));  // shifted by 0.1 px at most
  CHECK(frontend.pixel.y() == Approx(40.0).margin(0.1));
  CHECK(frontend.states.front() == TrackingState::tracking);
}

TEST_CASE("Exchanges after a number of observations are more frequent where there are more observations") {
  PipelineOptions options;
  options.interval = 0.1;
  options.observations = 20;
  Listener frontend(tracks({{0.0, 1.0}}), {});
  run(frontend, 2.0, options);
  CHECK(frontend.exchanges == Approx(50).margin(11));  // 1,001 observations, and intervals' ends
}

TEST_CASE("A camera that is stationary for ten seconds is not lost, and the stationary period is reported") {
  for (const char* mode : {"sequential", "concurrent"}) {
    PipelineOptions options;
    options.mode = mode;
    std::vector<TrackObservation> before = tracks({{0.0, 2.0}});
    for (const TrackObservation& z : tracks({{12.0, 13.0}})) before.push_back(z);  // the same tracks
    Listener frontend(before, {true, false, false});
    const RunResult result = run(frontend, 13.0, options);
    CHECK(result.status.state != RunState::lost);
    REQUIRE(result.stationary.size() == 1);
    CHECK(result.stationary[0].from == Approx(2.0).margin(0.01));
    CHECK(result.stationary[0].to == Approx(12.0).margin(0.1));
    CHECK(std::ranges::count(frontend.states, TrackingState::stationary) > 900);
  }
}

TEST_CASE("A stationary period just before the end of the data is kept, though all tracks end then") {
  std::vector<TrackObservation> before = tracks({{0.0, 2.0}});
  for (TrackId track = 0; track < 10; ++track) before.push_back({track, 4.95, Vector2(60.0, 80.0), 1.0});
  before.resize(before.size() - 9);  // one of them moves
  for (TrackId track = 1; track < 10; ++track) before.push_back({track, 4.995, Vector2(60.0, 80.0), 1.0});
  Listener frontend(before, {true, false, false});
  const RunResult result = run(frontend, 5.0);
  CHECK(result.status.state != RunState::lost);
  REQUIRE(result.stationary.size() >= 1);
  CHECK(result.stationary[0].from == Approx(2.0).margin(0.01));
  CHECK(result.segments.size() == 1);
}

TEST_CASE("After a loss another back-end starts, the trajectory has segments, and the longest one is reported") {
  Listener frontend(tracks({{0.0, 1.0}, {4.0, 7.0}}), {true, false, false});
  const RunResult result = run(frontend, 7.0);
  CHECK(result.status.state == RunState::lost);
  CHECK(result.status.time == Approx(1.0).margin(0.1));
  REQUIRE(result.segments.size() == 2);
  CHECK(result.longest == 1);
  CHECK(result.segments[0].final_trajectory.end() < 1.1);
  CHECK(result.segments[1].final_trajectory.start() == Approx(4.0).margin(0.02));
  CHECK(result.segments[1].final_trajectory.end() == Approx(7.0).margin(0.02));
  REQUIRE_FALSE(result.status.degraded.empty());
  CHECK(std::ranges::count(frontend.states, TrackingState::lost) == 1);
}

TEST_CASE("The same back-end continues after a gap within the patience") {
  Listener frontend(tracks({{0.0, 1.0}, {1.5, 3.0}}), {});
  const RunResult result = run(frontend, 3.0);
  CHECK(result.status.state == RunState::degraded);
  CHECK(result.segments.size() == 1);
}

TEST_CASE("A run without any observation fails with a reason, after its whole range") {
  Listener frontend({}, {});
  const RunResult result = run(frontend, 3.0);
  CHECK(result.status.state == RunState::failed);
  CHECK_FALSE(result.status.reason.empty());
  CHECK(result.segments.empty());
  CHECK(result.data_s == 0.0);
}

TEST_CASE("A front-end that breaks its contract ends the run with a message that says how") {
  class Broken : public FrontEnd {
   public:
    explicit Broken(TrackBatch batch) : batch_(std::move(batch)) {}
    bool advance(const Horizon& horizon, TrackBatch& batch) override {
      if (horizon.t > 0.995) batch = batch_;
      batch.until = horizon.t > 0.995 ? batch_.until : horizon.t;
      return true;
    }

   private:
    TrackBatch batch_;
  };
  const TrackObservation early{1, 0.5, {1, 1}, 1}, late{1, 1.5, {1, 1}, 1}, a{1, 0.999, {1, 1}, 1},
      b{1, 0.998, {1, 1}, 1};
  const std::pair<TrackBatch, const char*> cases[] = {
      {{{early}, {}, 1.0}, "has an observation at 0.5"}, {{{late}, {}, 1.0}, "has an observation at 1.5"},
      {{{a, b}, {}, 1.0}, "out of time order"},          {{{}, {{1, 1.2}}, 1.0}, "ends a track at 1.2"},
      {{{}, {}, 2.0}, "ends at a wrong time"},           {{{}, {}, 0.99}, "ends at a wrong time"},
      {{{}, {}, std::nan("")}, "ends at a wrong time"},  {{{}, {{1, 0.999}, {2, 0.998}}, 1.0}, "ends tracks out of"},
  };
  for (const auto& [batch, message] : cases) {
    for (const char* mode : {"sequential", "concurrent", "free"}) {
      PipelineOptions options;
      options.mode = mode;
      Broken frontend(batch);
      CHECK_THROWS_WITH(run(frontend, 2.0, options), ContainsSubstring(message));
    }
  }
}

TEST_CASE("A track's end reaches the back-end although the batch's end has not advanced") {
  class Ending : public FrontEnd {
   public:
    bool advance(const Horizon& horizon, TrackBatch& batch) override {
      batch.until = horizon.t < 0.9 ? std::min(horizon.t, 0.5) : horizon.t;
      batch.seen = horizon.t;
      if (horizon.t > 0.7 && !std::exchange(ended_, true)) batch.ended.push_back({3, 0.5});
      return true;
    }

   private:
    bool ended_ = false;
  };
  class CountsEnds : public Mean {
   public:
    CountsEnds(const BackEndContext& context, int& ends) : Mean(context), ends_(ends) {}
    void advance(const UndistortedBatch& batch) override {
      ends_ += static_cast<int>(batch.ended.size());
      Mean::advance(batch);
    }

   private:
    int& ends_;
  };
  int ends = 0;
  Ending frontend;
  const MakeBackEnd make = [&](const BackEndContext& context) { return std::make_unique<CountsEnds>(context, ends); };
  PipelineOptions options;
  run_pipeline(EmptySource(0.9), frontend, make, {}, options, 0.0);
  CHECK(ends == 1);
}

TEST_CASE("An error in the back-end ends a run in every mode") {
  class Throws : public Mean {
   public:
    using Mean::Mean;
    void advance(const UndistortedBatch& batch) override {
      if (batch.until > 0.5) throw std::runtime_error("the back-end broke");
      Mean::advance(batch);
    }
  };
  for (const char* mode : {"sequential", "concurrent", "free"}) {
    PipelineOptions options;
    options.mode = mode;
    options.queue = 1;
    Listener frontend(tracks({{0.0, 2.0}}), {true, false, false});
    const auto make = [](const BackEndContext& context) { return std::make_unique<Throws>(context); };
    CHECK_THROWS_WITH(run(frontend, 2.0, options, make), "the back-end broke");
  }
}

TEST_CASE("Causal poses that are not finite, or whose known_at decreases, are an error") {
  class PublishesPose : public Mean {
   public:
    PublishesPose(const BackEndContext& context, CausalPose pose)
        : Mean(context), publish_(context.publish), pose_(pose) {}
    void advance(const UndistortedBatch& batch) override {
      if (batch.until > 0.5) publish_({{batch.until, {}}});
      if (batch.until > 0.5) publish_(pose_);
    }

   private:
    std::function<void(const CausalPose&)> publish_;
    CausalPose pose_;
  };
  Listener frontend(tracks({{0.0, 2.0}}), {});
  const auto publishing = [](const CausalPose& pose) {
    return [pose](const BackEndContext& context) { return std::make_unique<PublishesPose>(context, pose); };
  };
  CHECK_THROWS_WITH(run(frontend, 2.0, {}, publishing({{0.5, {}}, 0.5})),
                    ContainsSubstring("known at 0.500000 s after one"));
  const SE3 broken{Eigen::Quaterniond::Identity(), {0, std::nan(""), 0}};
  CHECK_THROWS_WITH(run(frontend, 2.0, {}, publishing({{0.5, broken}})), ContainsSubstring("not finite"));
  const Vector6 no_velocity = Vector6::Constant(std::nan(""));
  CHECK_THROWS_WITH(run(frontend, 2.0, {}, publishing({{0.5, {}}, {}, no_velocity})), ContainsSubstring("not finite"));
}

TEST_CASE("Poses published again for an older time are kept with their known_at, apart from the causal trajectory") {
  class Smooths : public Mean {
   public:
    explicit Smooths(const BackEndContext& context) : Mean(context), publish_(context.publish) {}
    void advance(const UndistortedBatch& batch) override {
      const SE3 T;
      publish_({{batch.until - 0.005, T}, batch.until - 0.002});
      if (batch.until > 0.5) publish_({{batch.until - 0.205, T}});
    }
    void finish() override {}
    PoseTrajectory trajectory() const override {
      return PoseTrajectory(std::vector<StampedPose>{{0.0, {}}, {1.0, {}}});
    }

   private:
    std::function<void(const CausalPose&)> publish_;
  };
  Listener frontend(tracks({{0.0, 1.0}}), {});
  const RunResult result =
      run(frontend, 1.0, {}, [](const BackEndContext& context) { return std::make_unique<Smooths>(context); });
  const std::vector<CausalPose>& published = result.segments.at(0).published;
  const PoseTrajectory& causal = result.segments.at(0).causal_trajectory;
  CHECK(causal.size() == 100);
  CHECK(published.size() == 150);
  CHECK(published.back().t == Approx(0.795));
  CHECK(published.back().known_at == Approx(1.0));
  CHECK(published[published.size() - 2].known_at == Approx(0.998));
}

TEST_CASE("In mode free, feedback arrives as soon as it is available, and the log says that this isn't reproducible") {
  PipelineOptions options;
  options.mode = "free";
  options.latency = 5.0;
  Listener frontend(tracks({{0.0, 2.0}}), {true, false, false});
  const RunResult result = run(frontend, 2.0, options);
  CHECK_FALSE(frontend.received.empty());
  CHECK_THAT(result.log.back(), ContainsSubstring("not reproducible"));
}
