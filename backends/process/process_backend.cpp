#include "backends/process/process_backend.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <utility>

#include "core/plugin/registration.hpp"

namespace evbench::process {
namespace {

const Registration<BackEnd, ProcessBackEnd> registration(
    "process", "a command in any language (docs/reference/process_protocol.md)");

Json greeting(const ProcessOptions& options, const BackEndContext& context) {
  const PinholeCamera& camera = context.camera;
  return {{"kind", "backend"},
          {"seed", context.seed},
          {"patience", context.patience},
          {"camera", {{"fx", camera.fx}, {"fy", camera.fy}, {"cx", camera.cx}, {"cy", camera.cy}}},
          {"options", options.options}};
}

void check_not_later(double t, double until, const Place& place) {
  if (t > until) {
    throw MessageError(
        fmt::format("{}: time {} s is later than what has been seen; expected at most {} s", place.text(), t, until));
  }
}

}  // namespace

ProcessBackEnd::ProcessBackEnd(const Options& options, const BackEndContext& context)
    : context_(context), dialogue_(options, context.place, context.folder), monitor_(context.patience) {
  dialogue_.open(greeting(options, context));
  context_.log("back-end process: " + dialogue_.name());
}

void ProcessBackEnd::advance(const UndistortedBatch& batch) {
  const auto start = std::chrono::steady_clock::now();
  Line line;
  line.push_back('{');
  left_out_ += write_batch(line, batch);
  line.push_back('}');
  dialogue_.ask(line, fmt::format("the batch until {} s", batch.until), [&](const Json& answer) {
    check_keys(answer, {"state", "reason", "causal_poses", "online", "newest", "covariance", "outliers", "expected"});
    take_state(answer, batch.until);
    take_published(answer, batch.until);
    take_newest(answer, batch.until);
  });
  UpdateRecord record;
  record.t = batch.until;
  record.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  record.observations = static_cast<int>(batch.observations.size());
  updates_.push_back(record);
}

void ProcessBackEnd::take_state(const Json& answer, double until) {
  using enum TrackingState;
  const TrackingState before = feedback_.state, now = tracking_state(require(answer, "state"));
  const Json* const given = find(answer, "reason");
  const std::string reason = given != nullptr ? text(*given, {"reason"}) : "reported by the process";
  const double from = updates_.empty() ? until : updates_.back().t;
  if (now == no_map && before != no_map) {
    if (has_published_ || before == lost) {
      throw MessageError(
          "state: expected \"lost\", because poses were published or it was reported before, found \"no_map\"");
    }
    monitor_ = TrackingMonitor(context_.patience);  // its status was that of a wrong map
  }
  if (now == lost) {
    const bool was_degraded = before == degraded && !monitor_.status().degraded.empty();
    monitor_.lose(was_degraded ? monitor_.status().degraded.back().from : from, reason);
  } else if (now != no_map) {
    // Whether the motion model was alone for longer than the patience is up to the process: it distinguishes lost from
    // degraded.
    const auto support = now == degraded ? TrackingMonitor::Support::weak : TrackingMonitor::Support::full;
    monitor_.observe(from, until, support, reason);
  }
  feedback_.state = now;
}

void ProcessBackEnd::take_published(const Json& answer, double until) {
  const char* const key = find(answer, "causal_poses") != nullptr ? "causal_poses" : "online";  // before version 1.0
  const Json* const found = find(answer, key);
  if (found == nullptr) return;
  for (std::size_t i = 0; i < list(*found, {key}).size(); ++i) {
    const auto [pose, velocity] = moving_pose((*found)[i], {key, i});
    check_not_later(pose.t, until, {key, i});
    context_.publish({pose, until, velocity});
    has_published_ = true;
  }
}

void ProcessBackEnd::take_newest(const Json& answer, double until) {
  const std::optional<ControlState> before = std::exchange(feedback_.newest, std::nullopt);
  feedback_.covariance.reset();
  feedback_.expected.clear();
  if (const Json* const found = find(answer, "newest")) {
    const auto [pose, velocity] = moving_pose(*found, {"newest"});
    check_not_later(pose.t, until, {"newest"});
    feedback_.newest = ControlState{pose.t, pose.T, velocity.value_or(Vector6::Zero())};
    if (!velocity && before && before->t < pose.t) {
      feedback_.newest->velocity = se3::log(before->T.inverse() * pose.T) / (pose.t - before->t);
    } else if (!velocity && before && before->t == pose.t) {
      feedback_.newest->velocity = before->velocity;
    }
  }
  if (const Json* const found = find(answer, "covariance")) {
    if (!feedback_.newest) throw MessageError("covariance: expected \"newest\" with it: the pose that it is of");
    feedback_.covariance = evbench::process::covariance(*found);
  }
  if (const Json* const found = find(answer, "expected")) feedback_.expected = expected_features(*found);
  if (const Json* const found = find(answer, "outliers")) {
    for (std::size_t i = 0; i < list(*found, {"outliers"}).size(); ++i) {
      feedback_.outliers.push_back(integer((*found)[i], {"outliers", i}));
    }
  }
}

BackEndFeedback ProcessBackEnd::feedback(const FeedbackNeeds& needs) {
  BackEndFeedback result = feedback_;
  feedback_.outliers.clear();
  if (!needs.covariance) result.covariance.reset();
  if (!needs.expected) result.expected.clear();
  return result;
}

std::optional<Matrix12> ProcessBackEnd::covariance(double t) {
  if (!feedback_.newest || feedback_.newest->t != t) return std::nullopt;
  return feedback_.covariance;
}

void ProcessBackEnd::finish() {
  dialogue_.finish([this](const Json& answer) { take_final(answer); });
  if (left_out_ > 0) context_.log(fmt::format("{} observations that are not finite (not sent)", left_out_));
  if (const std::string errors = dialogue_.errors(); !errors.empty()) {
    context_.log("standard error of the back-end process:" + errors);
  }
}

void ProcessBackEnd::take_final(const Json& answer) {
  check_keys(answer, {"trajectory", "map", "status"});
  trajectory_ = PoseTrajectory(poses(require(answer, "trajectory"), "trajectory"));
  if (const Json* const found = find(answer, "map")) map_ = landmarks(*found);
  const double end = updates_.empty() ? 0.0 : updates_.back().t;
  if (trajectory_.empty()) monitor_.fail(end, "the process has given no trajectory");
  const Json* const given = find(answer, "status");
  if (given != nullptr && !trajectory_.empty()) take_status(*given);
}

/// The process may know more exactly when it was degraded or lost than its states show, but it may not deny that it
/// was.
void ProcessBackEnd::take_status(const Json& given) {
  if (!given.is_object()) throw MessageError("status: expected an object");
  check_keys(given, {"state", "reason", "time", "degraded"});
  Status result;
  result.state = run_state(require(given, "state"));
  if (result.state < RunState::lost && monitor_.status().state == RunState::lost) {
    throw MessageError("status.state: expected \"lost\" or \"failed\" of a process that has reported that it is lost");
  }
  if (const Json* const found = find(given, "degraded")) result.degraded = degraded_spans(*found);
  if (result.state != RunState::ok) {
    result.reason = text(require(given, "reason"), {"status.reason"});
    result.time = number(require(given, "time"), {"status.time"});
  }
  final_status_ = std::move(result);
}

}  // namespace evbench::process
