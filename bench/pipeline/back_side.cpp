#include "bench/pipeline/back_side.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <stdexcept>
#include <type_traits>
#include <utility>

namespace evbench {
namespace {

/// At that rate [Hz]; the back-end's own poses where the rate is 0, or so low that there would be none.
PoseTrajectory sample(const BackEnd& backend, double rate) {
  const PoseTrajectory own = backend.trajectory();
  if (rate == 0.0 || own.empty()) return own;
  std::vector<StampedPose> poses;
  const auto first = static_cast<std::int64_t>(std::ceil(own.start() * rate - 1e-9));
  for (std::int64_t k = first; static_cast<double>(k) / rate <= own.end(); ++k) {
    const double t = static_cast<double>(k) / rate;
    std::optional<SE3> T = backend.pose(t);
    if (!T) T = own.pose(t);
    if (T) poses.push_back({t, *T});
  }
  if (poses.empty()) return own;
  return PoseTrajectory(std::move(poses), "the back-end's trajectory");
}

bool is_finite(const StampedPose& pose) { return pose.T.p.allFinite() && pose.T.q.coeffs().allFinite(); }

/// Each pose that was the newest when it was told.
PoseTrajectory newest_poses(const std::vector<OnlinePose>& told) {
  std::vector<StampedPose> poses;
  for (const OnlinePose& pose : told) {
    if (poses.empty() || pose.t > poses.back().t) poses.push_back(pose);
  }
  return PoseTrajectory(std::move(poses), "the online trajectory");
}

template <class Value>
void append(std::string& bytes, const Value& value) {
  static_assert(std::is_trivially_copyable_v<Value> && sizeof(TrackId) == sizeof(double));  // no padding
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

double length(const Piece& piece) { return piece.final_trajectory.end() - piece.final_trajectory.start(); }

}  // namespace

BackSide::BackSide(const MakeBackEnd& make, BackEndContext context, const Camera& camera,
                   const Source::TimeRange& range, const PipelineOptions& options)
    : make_(make),
      context_(std::move(context)),
      camera_(camera),
      range_(range),
      standstill_(options.still_after),
      until_(range.from),
      seen_(range.from) {
  context_.camera = camera.pinhole;
  context_.patience = options.patience;
  begin();
}

void BackSide::begin() {
  auto estimator = std::make_unique<Estimator>();
  BackEndContext context = context_;
  context.online = [this, &heard = *estimator](const OnlinePose& pose) { hear(pose, heard); };
  estimator->backend = watch_.time([&] { return make_(context); });
  estimators_.push_back(std::move(estimator));
}

/// A pose ahead of the data counts as known when its time has come. A back-end knows the times of the observations that
/// it makes poses from; where a front-end tells those late, the poses are known as much later.
void BackSide::hear(OnlinePose pose, Estimator& estimator) const {
  if (!std::isfinite(pose.t) || !is_finite(pose) || (pose.velocity && !pose.velocity->allFinite())) {
    throw std::runtime_error(fmt::format("the back-end's pose at {:.6f} s is not finite", pose.t));
  }
  const double said = std::max(pose.t, pose.known_at.value_or(seen_));
  std::vector<OnlinePose>& told = estimator.told;
  if (!told.empty() && !(said >= estimator.said)) {
    throw std::runtime_error(fmt::format(
        "the back-end told an online pose as known at {:.6f} s after one known at {:.6f} s", said, estimator.said));
  }
  estimator.said = said;
  const double complete = pose.known_at.value_or(seen_), late = seen_ - until_;
  pose.known_at = std::max(pose.t, complete < seen_ ? std::min(complete + late, seen_) : complete);
  // What comes less late than what was told before it has waited for that.
  if (!told.empty()) pose.known_at = std::max(*pose.known_at, *told.back().known_at);
  told.push_back(pose);
  if (!estimator.newest || pose.t >= estimator.newest->t) estimator.newest = pose;
}

void BackSide::take(TrackBatch batch) {
  observations_ += batch.observations.size();
  undistort(batch);
  standstill_.apply(batch);
  digest(batch);
  if (estimators_.back()->backend->status().state == RunState::lost) {
    context_.log(fmt::format("{:.3f} s: another back-end starts, in a world frame of its own", until_));
    begin();
  }
  until_ = batch.until;
  seen_ = batch.known_at();
  Estimator& estimator = *estimators_.back();
  watch_.time([&] { estimator.backend->advance(batch); });
  if (estimator.newest) estimator.covariances.take(*estimator.newest, *estimator.backend);
  work_.push_back({seen_, watch_.seconds() - std::exchange(counted_, watch_.seconds())});
}

Feedback BackSide::feedback(const FeedbackNeeds& needs) {
  Feedback feedback = watch_.time([&] { return estimators_.back()->backend->feedback(needs); });
  feedback.t = until_;
  if (standstill_.holds() && feedback.state == TrackingState::tracking) feedback.state = TrackingState::standing_still;
  for (ExpectedFeature& feature : feedback.expected) {
    feature.pixel = camera_.project(camera_.pinhole.ray(feature.pixel));
  }
  std::erase_if(feedback.expected, [&](const ExpectedFeature& feature) { return !camera_.contains(feature.pixel); });
  return feedback;
}

/// Pixels of the ideal pinhole; observations that have none are left out and counted.
void BackSide::undistort(TrackBatch& batch) {
  left_out_ += std::erase_if(batch.observations, [&](TrackObservation& z) {
    const std::optional<Vector2> pixel = camera_.undistort(z.pixel);
    if (pixel) z.pixel = *pixel;
    return !pixel;
  });
}

/// All of a batch at once: a call of the hash for each value would cost more than the rest of an exchange.
void BackSide::digest(const TrackBatch& batch) {
  struct Seen {
    TrackId track;
    double t, u, v, sigma;
  };
  struct Ended {
    TrackId track;
    double t;
  };
  for (const TrackObservation& z : batch.observations) {
    append(digested_, Seen{z.track, z.t, z.pixel.x(), z.pixel.y(), z.sigma});
  }
  for (const TrackEnd& end : batch.ended) append(digested_, Ended{end.track, end.t});
  hash_.add(digested_);
  digested_.clear();
}

RunProgress BackSide::progress() const {
  RunProgress result{until_, range_.to, standstill_.tracks()};
  const Estimator& estimator = *estimators_.back();
  if (const auto updates = estimator.backend->updates(); !updates.empty()) {
    result.states = updates.back().states;
    result.landmarks = updates.back().landmarks;
  }
  if (estimator.newest) result.delay = seen_ - estimator.newest->t;
  return result;
}

void BackSide::finish(double rate, RunResult& result) {
  std::vector<bool> has_piece;
  for (const auto& estimator : estimators_) {
    watch_.time([&] { estimator->backend->finish(); });
    const std::size_t before = result.pieces.size();
    add_piece(*estimator, rate, result);
    has_piece.push_back(result.pieces.size() > before);
  }
  result.status = merged_status(has_piece);
  for (std::size_t i = 1; i < result.pieces.size(); ++i) {
    if (length(result.pieces[i]) > length(result.pieces[result.longest])) result.longest = i;
  }
  result.still = standstill_.spans();
  result.observations = observations_;
  result.tracks_sha256 = hash_.hex();
  if (left_out_ > 0) {
    result.log.push_back(fmt::format("{} observations left out: the lens model has no inverse there", left_out_));
  }
}

/// The estimator's piece, where it has one, and its updates.
void BackSide::add_piece(Estimator& estimator, double rate, RunResult& result) const {
  BackEnd& backend = *estimator.backend;
  result.learnt = backend.learnt();
  result.updates.insert(result.updates.end(), backend.updates().begin(), backend.updates().end());
  Piece piece;
  piece.final_trajectory = sample(backend, rate);
  if (!std::ranges::all_of(piece.final_trajectory.poses(), is_finite)) {
    throw std::runtime_error("the back-end's trajectory is not finite");
  }
  const Status status = backend.status();
  if (piece.final_trajectory.empty() || status.state == RunState::failed) return;
  // What was told after the data had ended is no estimate from data.
  piece.told = std::move(estimator.told);
  if (status.state == RunState::lost) {
    std::erase_if(piece.told, [&](const OnlinePose& pose) { return pose.t > status.time; });
  }
  piece.online_trajectory = newest_poses(piece.told);
  piece.map = backend.map();
  piece.problem = backend.problem();
  piece.relative = estimator.covariances.finish(backend);
  result.pieces.push_back(std::move(piece));
}

/// One back-end's status is the run's; with several, the run was lost when the first was, and parts are missing.
Status BackSide::merged_status(const std::vector<bool>& has_piece) const {
  Status merged = estimators_.front()->backend->status();
  for (std::size_t i = 0; i + 1 < estimators_.size(); ++i) {
    const Status lost = estimators_[i]->backend->status();
    const Status next = estimators_[i + 1]->backend->status();
    const bool anew = has_piece[i + 1];
    merged.degraded.push_back(
        {lost.time, anew ? estimators_[i + 1]->backend->trajectory().start() : range_.to, "lost: " + lost.reason});
    merged.degraded.insert(merged.degraded.end(), next.degraded.begin(), next.degraded.end());
  }
  if (std::ranges::none_of(has_piece, std::identity{})) {
    merged.state = RunState::failed;
    if (merged.reason.empty()) merged.reason = "no trajectory";
  }
  return merged;
}

}  // namespace evbench
