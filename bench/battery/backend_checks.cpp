#include <algorithm>
#include <cmath>

#include "bench/battery/battery.hpp"
#include "bench/battery/track_source.hpp"
#include "bench/pipeline/pipeline.hpp"

namespace evbench::battery {
namespace {

/// A back-end made as from a config, and its runs.
class CandidateBackEnd {
 public:
  CandidateBackEnd(const Plugins& plugins, const std::string& name, const Json& options)
      : entry_(plugins.of<BackEnd>().find(name, "battery")), options_(entry_.resolve(options, name, ".")) {}

  RunResult run(const SequenceOptions& sequence, const PipelineOptions& options = {}) const {
    const TrackSource source(sequence);
    TrackFrontEnd frontend(source);
    return run(source, frontend, options);
  }
  RunResult run(const Source& source, FrontEnd& frontend, const PipelineOptions& options = {}) const {
    const auto make = [&](const BackEndContext& context) { return entry_.make(options_, context); };
    BackEndContext context;
    context.seed = 1;
    const RunResult result = run_pipeline(source, frontend, make, context, options, 0.0);
    check_sound(result, source.time_range().to);
    return result;
  }

 private:
  static void check_sound(const RunResult& result, double end);

  const Registry<BackEnd>::Entry& entry_;
  Json options_;
};

void check_poses(const PoseTrajectory& trajectory, const char* which, double end) {
  for (const auto& [t, T] : trajectory.poses()) {
    require(T.p.allFinite() && T.q.coeffs().allFinite(), "the {} pose at {} s is not finite", which, t);
    require(t <= end + 0.1, "there is a {} pose at {} s, after the end at {} s", which, t, end);
  }
}

/// Checks what must hold for any run: finite, within the data's time range, and a consistent state.
void CandidateBackEnd::check_sound(const RunResult& result, double end) {
  for (const TrajectorySegment& segment : result.segments) {
    check_poses(segment.final_trajectory, "final", end);
    check_poses(segment.causal_trajectory, "causal", end);
    for (const Landmark& landmark : segment.map) {
      require(landmark.position.allFinite(), "landmark {} is not finite", landmark.track);
    }
  }
  for (const UpdateRecord& update : result.updates) {
    require(std::isfinite(update.cost.value_or(0.0)), "the cost of the update at {} s is not finite", update.t);
    require(update.t <= end + 0.1, "there is an update at {} s, after the end at {} s", update.t, end);
  }
  const Status& status = result.status;
  if (status.state != RunState::ok) {
    require(!status.reason.empty(), "it is {} without a reason", to_string(status.state));
    require(std::isfinite(status.time), "the time at which it is {} is not finite", to_string(status.state));
  }
  require((status.state == RunState::failed) == result.segments.empty(), "it is {} and has {} trajectories",
          to_string(status.state), result.segments.size());
}

const TrajectorySegment& longest(const RunResult& result) {
  require(!result.segments.empty(), "it makes no trajectory: {}", result.status.reason);
  return result.segments[result.longest];
}

void follows_a_good_sequence(const CandidateBackEnd& candidate) {
  const RunResult result = candidate.run({});
  const TrajectorySegment& segment = longest(result);
  require(result.status.state <= RunState::degraded, "it is {}: {}", to_string(result.status.state),
          result.status.reason);
  require(segment.final_trajectory.end() > 2.5, "its trajectory ends at {} s of 3 s", segment.final_trajectory.end());
  require(segment.map.size() > 10, "its map has {} landmarks, where 50 tracks are seen", segment.map.size());
  require(!segment.causal_trajectory.empty(), "it published no causal pose");
}

void fails_with_too_little(const CandidateBackEnd& candidate) {
  const auto nothing = candidate.run({.keep = [](TrackObservation&) { return false; }});
  require(nothing.status.state == RunState::failed, "without observations it is {}", to_string(nothing.status.state));
  const auto one = candidate.run({.keep = [](TrackObservation& z) { return z.track == 0; }});
  require(one.status.state == RunState::failed, "with one track it is {}", to_string(one.status.state));
  bool first = true;
  const auto single = candidate.run({.keep = [&](TrackObservation&) { return std::exchange(first, false); }});
  require(single.status.state == RunState::failed, "with one observation it is {}", to_string(single.status.state));
}

/// Tracks end at `from` and others begin at `to`.
SequenceOptions interrupted(double duration, double from, double to) {
  SequenceOptions sequence;
  sequence.duration = duration;
  sequence.keep = [=](TrackObservation& z) {
    if (z.t > to) z.track += 100'000;
    return z.t < from || z.t > to;
  };
  return sequence;
}

void survives_a_gap(const CandidateBackEnd& candidate) {
  const RunResult result = candidate.run(interrupted(3.0, 1.8, 2.1));
  longest(result);
  require(result.status.state != RunState::ok, "it is ok, though nothing was seen from 1.8 to 2.1 s");
  require(result.status.state == RunState::lost || !result.status.degraded.empty(), "no span is reported as degraded");
}

void keeps_its_estimate(const CandidateBackEnd& candidate) {
  SequenceOptions sequence;
  sequence.range = 6.0;
  sequence.keep = [](TrackObservation& z) { return z.t < 2.0; };
  const RunResult result = candidate.run(sequence);
  require(result.status.state == RunState::lost, "it is {}, though all tracks ended at 2 s of 6 s",
          to_string(result.status.state));
  require(result.status.time > 1.5, "it is lost at {} s, though tracks ended at 2 s", result.status.time);
  const double end = longest(result).final_trajectory.end();
  require(end > 1.5 && end < 3.1, "its trajectory ends at {} s, though tracks ended at 2 s", end);
  require(std::abs(result.data_s - 2.0) < 0.1, "{} s of data were counted instead of 2", result.data_s);
}

void reinitialises_after_a_loss(const CandidateBackEnd& candidate) {
  const RunResult result = candidate.run(interrupted(8.0, 2.5, 5.0));
  require(result.status.state == RunState::lost, "it is {}, though nothing was seen for 2.5 s",
          to_string(result.status.state));
  require(result.segments.size() == 2, "its trajectory has {} segments; expected one before the loss and one after it",
          result.segments.size());
  const double first = result.segments[0].final_trajectory.end(), second = result.segments[1].final_trajectory.start();
  require(first < 3.6, "the first segment goes on to {} s, though nothing was seen from 2.5 s on", first);
  require(second > 4.9 && second < 7.0, "the second segment begins at {} s, though tracks came back at 5 s", second);
}

void makes_no_map_at_rest(const CandidateBackEnd& candidate) {
  const RunResult result = candidate.run({.motion = R"({"kind": "robot_arm", "period": 3, "hold": [0, 3]})"});
  require(result.status.state == RunState::failed, "it is {} before a camera that never moves",
          to_string(result.status.state));
}

/// Between 4 and 14 s the camera does not move and nothing is observed; no track ends.
void survives_a_stationary_period(const CandidateBackEnd& candidate) {
  SequenceOptions sequence;
  sequence.duration = 16.0;
  sequence.motion = R"({"kind": "robot_arm", "period": 4, "hold": [4, 14]})";
  sequence.tracks = R"({"alive": 50, "rate": [50, 100], "lifetime": [20, 30], "noise": 0.3})";
  sequence.keep = [](TrackObservation& z) { return z.t < 4.0 || z.t > 14.0; };
  const RunResult result = candidate.run(sequence);
  const TrajectorySegment& segment = longest(result);
  require(result.status.state <= RunState::degraded, "it is {}: {}, though the camera was only stationary",
          to_string(result.status.state), result.status.reason);
  require(!result.stationary.empty() && result.stationary.front().to > 13.0,
          "the stationary period from 4 to 14 s was not detected");
  const PoseTrajectory& trajectory = segment.final_trajectory;
  require(trajectory.end() > 15.5, "its trajectory ends at {} s of 16 s", trajectory.end());
  const auto early = trajectory.pose(5.0), late = trajectory.pose(13.5);
  require(early && late, "it has no pose while the camera is stationary");
  double extent = 0.0;
  for (const StampedPose& pose : trajectory.poses()) extent = std::max(extent, (pose.T.p - early->p).norm());
  require((late->p - early->p).norm() <= 0.1 * extent,
          "it moves by {:.1f} % of the path's extent during the stationary period",
          100.0 * (late->p - early->p).norm() / extent);
}

void stays_finite_with_wild_tracks(const CandidateBackEnd& candidate) {
  std::int64_t i = 0;
  candidate.run({.keep = [&](TrackObservation& z) {
    const auto n = static_cast<double>(i++);
    if (z.track % 4 == 0) z.pixel = {1e6 * std::sin(n), -1e9 * std::cos(3.0 * n)};
    return true;
  }});
}

/// [s] at least the length of a batch of bundle adjustment, which publishes a pose when the batch is complete.
constexpr double kLatency = 0.1;

void publishes_poses_in_time(const CandidateBackEnd& candidate) {
  constexpr double kCut = 2.0;
  const auto until = [&](double end) {
    SequenceOptions sequence;
    sequence.range = end;
    sequence.keep = [end](TrackObservation& z) { return z.t <= end; };
    const RunResult result = candidate.run(sequence);
    return result.segments.empty() ? std::vector<StampedPose>{} : longest(result).causal_trajectory.poses();
  };
  const auto early = until(kCut), all = until(3.0);
  require(!early.empty(), "it publishes no causal pose in 2 s");
  require(all.size() > early.size(), "it publishes no more causal poses in 3 s than in 2 s");
  for (std::size_t i = 0; i < early.size() && early[i].t < kCut - kLatency; ++i) {
    require(all[i].t == early[i].t && all[i].T.p == early[i].T.p,
            "its causal pose at {} s depends on later observations", early[i].t);
  }
  require(!until(all.front().t + kLatency).empty(), "its first causal pose, of {} s, is published more than {} s later",
          all.front().t, kLatency);
}

bool same(const PoseTrajectory& a, const PoseTrajectory& b) {
  return std::ranges::equal(a.poses(), b.poses(), [](const StampedPose& x, const StampedPose& y) {
    return x.t == y.t && x.T.p == y.T.p && x.T.q.coeffs() == y.T.q.coeffs();
  });
}

void check_same(const RunResult& a, const RunResult& b, const char* what) {
  require(a.segments.size() == b.segments.size(), "{}: {} and {} segments", what, a.segments.size(), b.segments.size());
  for (std::size_t i = 0; i < a.segments.size(); ++i) {
    require(same(a.segments[i].final_trajectory, b.segments[i].final_trajectory), "{}: final trajectories differ",
            what);
    require(same(a.segments[i].causal_trajectory, b.segments[i].causal_trajectory), "{}: causal trajectories differ",
            what);
    const auto equal = [](const Landmark& x, const Landmark& y) {
      return x.track == y.track && x.position == y.position;
    };
    require(std::ranges::equal(a.segments[i].map, b.segments[i].map, equal), "{}: maps differ", what);
  }
  require(a.status.state == b.status.state && a.status.reason == b.status.reason, "{}: states differ", what);
}

void repeats_itself(const CandidateBackEnd& candidate) {
  check_same(candidate.run({}), candidate.run({}), "the same observations twice");
}

void is_the_same_in_two_threads(const CandidateBackEnd& candidate) {
  const TrackSource source({});
  PipelineOptions options;
  TrackFrontEnd one(source, true), two(source, true);
  const RunResult sequential = candidate.run(source, one, options);
  options.mode = "concurrent";
  const RunResult concurrent = candidate.run(source, two, options);
  require(sequential.tracks_sha256 == concurrent.tracks_sha256,
          "in two threads its feedback differs: the front-end's tracks are not the same");
  check_same(sequential, concurrent, "in one thread and in two");
}

void check_feedback(const Feedback& feedback) {
  const double t = feedback.t;
  if (feedback.newest) {
    require(feedback.newest->t <= t + 1e-9, "the newest pose fed back at {} s is of {} s", t, feedback.newest->t);
    require(feedback.newest->T.p.allFinite() && feedback.newest->velocity.allFinite(),
            "the newest pose or velocity fed back at {} s is not finite", t);
  }
  if (feedback.covariance) {
    require(feedback.covariance->allFinite() && feedback.covariance->diagonal().minCoeff() >= 0.0,
            "the covariance fed back at {} s is not a covariance", t);
  }
  for (const ExpectedFeature& feature : feedback.expected) {
    require(feature.pixel.allFinite() && feature.position.allFinite() && feature.covariance.allFinite() &&
                feature.covariance.diagonal().minCoeff() > 0.0 && feature.covariance.determinant() >= 0.0,
            "the prediction of track {} at {} s is not finite, or its covariance is not a covariance", feature.track,
            t);
  }
}

/// Distances of the expected features from the next observations of their tracks [px].
std::vector<double> expectation_errors(const std::vector<Feedback>& received, std::span<const TrackObservation> seen) {
  std::vector<double> errors;
  for (const Feedback& feedback : received) {
    auto next = std::ranges::lower_bound(seen, feedback.t, {}, &TrackObservation::t);
    for (; next != seen.end() && next->t < feedback.t + 0.01; ++next) {
      for (const ExpectedFeature& feature : feedback.expected) {
        if (feature.track == next->track) errors.push_back((feature.pixel - next->pixel).norm());
      }
    }
  }
  return errors;
}

void gives_feedback(const CandidateBackEnd& candidate) {
  const TrackSource source({});
  TrackFrontEnd frontend(source, true);
  candidate.run(source, frontend);
  const std::vector<Feedback>& received = frontend.received();
  require(received.size() > 200, "only {} answers to 300 exchanges", received.size());
  require(received.front().state == TrackingState::no_map, "its first feedback is that it is {}",
          to_string(received.front().state));
  require(received.back().state == TrackingState::tracking || received.back().state == TrackingState::degraded,
          "its last feedback is that it is {}", to_string(received.back().state));
  std::ranges::for_each(received, check_feedback);
  std::vector<TrackId> outliers;
  for (const Feedback& feedback : received) {
    outliers.insert(outliers.end(), feedback.outliers.begin(), feedback.outliers.end());
  }
  std::ranges::sort(outliers);
  require(std::ranges::adjacent_find(outliers) == outliers.end(), "an outlier track is reported twice");
  std::vector<double> errors = expectation_errors(received, *source.true_tracks());
  if (errors.empty()) return;  // predictions are optional
  std::ranges::nth_element(errors, errors.begin() + std::ssize(errors) / 2);
  const double median = errors[errors.size() / 2];
  require(median < 5.0, "landmarks are expected {:.1f} px from where they are observed", median);
}

}  // namespace

std::vector<Check> backend_checks(const Plugins& plugins, const std::string& name, const Json& options) {
  const CandidateBackEnd candidate(plugins, name, options);
  const auto check = [&](const char* text, void (*run)(const CandidateBackEnd&)) {
    return Check{text, [=] { run(candidate); }};
  };
  return {
      check("follows a good sequence in time order and shows a map", follows_a_good_sequence),
      check("fails, with a reason, without observations, with one track, or with one observation",
            fails_with_too_little),
      check("survives a gap in which no track is alive, and reports it", survives_a_gap),
      check("is lost and keeps its estimate when all tracks end before the time range does", keeps_its_estimate),
      check("re-initialises in a second segment when tracks return after it was lost", reinitialises_after_a_loss),
      check("makes no map from a camera that never moves, and gives the reason", makes_no_map_at_rest),
      check("is not lost in a stationary period of ten seconds, and keeps its pose", survives_a_stationary_period),
      check("stays finite with a quarter of the tracks far out of the image", stays_finite_with_wild_tracks),
      check("publishes each causal pose in time and from earlier data only", publishes_poses_in_time),
      check("gives the same bits for the same observations", repeats_itself),
      check("gives the same bits in one thread and in two, its feedback included", is_the_same_in_two_threads),
      check("gives feedback: states, poses, outliers, predicted positions of landmarks", gives_feedback),
  };
}

}  // namespace evbench::battery
