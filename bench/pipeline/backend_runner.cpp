#include "bench/pipeline/backend_runner.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <set>
#include <type_traits>
#include <utility>

#include "core/geometry/in_view.hpp"

namespace evbench {
namespace {

template <class Value>
void append_value(std::string& bytes, const Value& value) {
  static_assert(std::is_trivially_copyable_v<Value> && sizeof(TrackId) == sizeof(double));  // no padding
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

/// By scale and rotation: one that is right in both has its landmarks elsewhere where the translation is wrong.
bool agree(const Similarity& a, const Similarity& b) {
  constexpr double kScale = 0.03, kAngle = 0.02;  // relative; [rad]
  return std::abs(std::log(a.scale / b.scale)) < kScale && a.T.q.angularDistance(b.T.q) < kAngle;
}

/// In the world to which `transform` carries that of the feedback.
void carry(Feedback& feedback, const Similarity& transform) {
  if (feedback.newest) {
    feedback.newest->T = transform * feedback.newest->T;
    feedback.newest->velocity.tail<3>() *= transform.scale;
  }
  if (feedback.covariance) {
    for (const int translation : {3, 9}) {
      feedback.covariance->middleRows<3>(translation) *= transform.scale;
      feedback.covariance->middleCols<3>(translation) *= transform.scale;
    }
  }
  for (ExpectedFeature& feature : feedback.expected) feature.position = transform * feature.position;
}

}  // namespace

BackEndRunner::BackEndRunner(const MakeBackEnd& make, BackEndContext context, const Camera& camera, const TimeRange& range,
                   const PipelineOptions& options)
    : make_(make),
      context_(std::move(context)),
      camera_(camera),
      range_(range),
      stationary_(options.stationary_after),
      relocalises_(options.relocalise),
      until_(range.from),
      seen_(range.from) {
  context_.camera = camera.pinhole;
  context_.patience = options.patience;
  begin();
}

void BackEndRunner::begin() {
  auto estimator = std::make_unique<Estimator>(estimators_.size());
  BackEndContext context = context_;
  context.publish = [this, &received = *estimator](const CausalPose& pose) { received.on_pose(pose, until_, seen_); };
  remembered_.clear();
  begun_ = next_relocalisation_ = until_;
  found_.reset();
  estimator->backend = watch_.time([&] { return make_(context); });
  estimators_.push_back(std::move(estimator));
}

void BackEndRunner::take(TrackBatch batch) {
  if (stationary_.refuted()) take_back(*stationary_.refuted());
  observations_ += batch.observations.size();
  undistort(batch);
  stationary_.apply(batch);
  digest(batch);
  if (estimators_.back()->status().state == RunState::lost) {
    context_.log(fmt::format("{:.3f} s: another back-end starts, in a world frame of its own", until_));
    begin();
  }
  until_ = batch.until;
  seen_ = batch.known_at();
  resolve_doubts(batch.ended);
  Estimator& estimator = *estimators_.back();
  watch_.time([&] { estimator.backend->advance(batch); });
  relocalise();
  if (estimator.newest) estimator.covariances.take(*estimator.newest, *estimator.backend);
  work_.push_back({seen_, watch_.seconds() - std::exchange(counted_, watch_.seconds())});
}

/// What it was told of a stand was wrong: its estimate ends where that began.
void BackEndRunner::take_back(const StationaryDetector::Rejected& stand) {
  Estimator& estimator = *estimators_.back();
  Status status = estimator.status();
  context_.log(fmt::format("{:.3f} s: from {:.3f} s on the camera did not stand still", until_, stand.span.from));
  if (!estimator.newest || status.state >= RunState::lost) return;
  status.state = RunState::lost;
  status.reason = "the camera moved while nothing was seen";
  status.time = stand.span.from;
  std::erase_if(status.degraded, [&](const DegradedSpan& span) { return span.from >= stand.span.from; });
  estimator.ended = status;
  estimator.doubtful = stand.survivors;
}

/// What ends in time has not been followed to something else, and may be recognised.
void BackEndRunner::resolve_doubts(const std::vector<TrackEnd>& ended) {
  constexpr double kSoon = 0.1;  // [s], before it is a landmark of the new map
  if (until_ - begun_ > kSoon) return;
  for (const auto& estimator : estimators_) {
    for (const TrackEnd& end : ended) estimator->doubtful.erase(end.track);
  }
}

/// Often while its map is young; then now and then, by landmarks that have joined. It counts when it is found in the
/// same place twice in succession: a young map may still change.
void BackEndRunner::relocalise() {
  constexpr double kPause = 0.1;    // [s] at least
  constexpr double kGrowth = 0.05;  // of the time since it began
  Estimator& estimator = *estimators_.back();
  if (!relocalises_ || estimators_.size() < 2 || !estimator.newest || until_ < next_relocalisation_) return;
  std::optional<Estimator::Found> found;
  for (std::size_t i = estimators_.size() - 1; i-- > 0 && !found;) {
    if (estimator.is_elsewhere() && estimators_[i]->world != estimator.world) continue;
    found = estimator.find_in(*estimators_[i], context_.camera);
  }
  if (found && found_ && found->world == found_->world && agree(found->to_world, found_->to_world)) {
    if (!estimator.is_elsewhere()) {
      context_.log(fmt::format("{:.3f} s: found in the world of before, by {} landmarks", until_, found->landmarks));
    }
    estimator.stand_in(*found);
    remember_landmarks();
  }
  found_ = found;
  next_relocalisation_ = until_ + std::max(kPause, kGrowth * (until_ - begun_));
}

void BackEndRunner::remember_landmarks() {
  remembered_.clear();
  for (const auto& estimator : estimators_) {
    if (estimator->world != estimators_.back()->world) continue;
    for (const Landmark& landmark : estimator->trusted_map()) {
      if (estimator == estimators_.back()) {
        remembered_.erase(landmark.track);
      } else {
        remembered_[landmark.track] = estimator->to_world * landmark.position;
      }
    }
  }
}

/// Those that may be in the image, and that the back-end has not told itself.
void BackEndRunner::expect_remembered(Feedback& feedback) const {
  constexpr double kSigma = 1.5;  // [px], of worlds that were found in one another
  if (!feedback.newest) return;
  const SE3 T = extrapolate(*feedback.newest, until_ - feedback.newest->t).T.inverse();
  std::set<TrackId> published;
  for (const ExpectedFeature& feature : feedback.expected) published.insert(feature.track);
  for (const auto& [track, position] : remembered_) {
    const Vector3 seen = T * position;
    if (!(seen.z() > 0.0) || published.contains(track)) continue;
    const Vector2 pixel = context_.camera.project(seen);
    const Matrix2 covariance = kSigma * kSigma * Matrix2::Identity();
    if (in_view(context_.camera, pixel, kLensReach)) feedback.expected.push_back({track, position, pixel, covariance});
  }
}

Feedback BackEndRunner::feedback(const FeedbackNeeds& needs) {
  Feedback feedback = watch_.time([&] { return estimators_.back()->backend->feedback(needs); });
  feedback.t = until_;
  const Estimator& estimator = *estimators_.back();
  feedback.world = estimator.world;
  carry(feedback, estimator.to_world);
  if (needs.expected) expect_remembered(feedback);
  if (stationary_.holds() && feedback.state == TrackingState::tracking) feedback.state = TrackingState::stationary;
  for (ExpectedFeature& feature : feedback.expected) {
    feature.pixel = camera_.project(camera_.pinhole.ray(feature.pixel));
  }
  std::erase_if(feedback.expected, [&](const ExpectedFeature& feature) { return !camera_.contains(feature.pixel); });
  return feedback;
}

/// Pixels of the ideal pinhole; observations that have none are left out and counted.
void BackEndRunner::undistort(TrackBatch& batch) {
  left_out_ += std::erase_if(batch.observations, [&](TrackObservation& z) {
    const std::optional<Vector2> pixel = camera_.undistort(z.pixel);
    if (pixel) z.pixel = *pixel;
    return !pixel;
  });
}

/// All of a batch at once: a call of the hash for each value would cost more than the rest of an exchange.
void BackEndRunner::digest(const TrackBatch& batch) {
  struct Seen {
    TrackId track;
    double t, u, v, sigma;
  };
  struct Ended {
    TrackId track;
    double t;
  };
  for (const TrackObservation& z : batch.observations) {
    append_value(digested_, Seen{z.track, z.t, z.pixel.x(), z.pixel.y(), z.sigma});
  }
  for (const TrackEnd& end : batch.ended) append_value(digested_, Ended{end.track, end.t});
  hash_.add(digested_);
  digested_.clear();
}

RunProgress BackEndRunner::progress() const {
  RunProgress result{until_, range_.to, stationary_.tracks()};
  const Estimator& estimator = *estimators_.back();
  if (const auto updates = estimator.backend->updates(); !updates.empty()) {
    result.states = updates.back().states;
    result.landmarks = updates.back().landmarks;
  }
  if (estimator.newest) result.delay = seen_ - estimator.newest->t;
  result.backend_s = seconds();
  return result;
}

void BackEndRunner::finish(double rate, RunResult& result) {
  add_segments(rate, result);
  for (std::size_t i = 1; i < result.segments.size(); ++i) {
    if (result.segments[i].covered > result.segments[result.longest].covered) result.longest = i;
  }
  result.stationary = stationary_.spans();
  result.observations = observations_;
  result.tracks_sha256 = hash_.hex();
  if (left_out_ > 0) {
    result.log.push_back(fmt::format("{} observations left out: the lens model has no inverse there", left_out_));
  }
}

/// Of each world that an estimator has made: by final estimates, worlds lie otherwise in one another than while data
/// came in.
void BackEndRunner::add_segments(double rate, RunResult& result) {
  std::map<std::size_t, std::size_t> segment_of;  // by world
  std::vector<bool> has_segment;
  for (const auto& estimator : estimators_) {
    BackEnd& backend = *estimator->backend;
    watch_.time([&] { backend.finish(); });
    result.learnt = backend.estimated_parameters();
    result.updates.insert(result.updates.end(), backend.updates().begin(), backend.updates().end());
    const std::size_t stood_in = estimator->world;
    std::vector<CausalPose> published_in_world = std::move(estimator->published_in_world);
    estimator->stand_alone();
    for (std::size_t i = estimator->number; relocalises_ && i-- > 0 && !estimator->is_elsewhere();) {
      if (!has_segment[i]) continue;
      if (const auto found = estimator->find_in(*estimators_[i], context_.camera)) estimator->stand_in(*found);
    }
    auto segment = estimator->segment(rate);
    has_segment.push_back(segment.has_value());
    if (!segment) continue;
    const auto [entry, is_new] = segment_of.try_emplace(estimator->world, result.segments.size());
    if (is_new) {
      result.segments.push_back(std::move(*segment));
    } else {
      const Status status = estimator->status();
      std::erase_if(published_in_world, [&](const CausalPose& pose) {
        return stood_in != estimator->world || (status.state == RunState::lost && pose.t > status.time);
      });
      go_on(result.segments[entry->second], std::move(*segment), estimator->to_world, std::move(published_in_world));
    }
  }
  result.status = merged_status(has_segment);
}

/// One back-end's status is the run's. With several the run was lost when the first was, and parts are missing; but
/// where all that followed were found in the world of the first, it went on.
Status BackEndRunner::merged_status(const std::vector<bool>& has_segment) const {
  constexpr const char* kFound = "then found in the same world";
  Status merged = estimators_.front()->status();
  bool went_on = estimators_.size() > 1;
  for (std::size_t i = 0; i + 1 < estimators_.size(); ++i) {
    const Status lost = estimators_[i]->status();
    const Estimator& next = *estimators_[i + 1];
    const Status status = next.status();
    const bool anew = has_segment[i + 1], found = anew && next.world == estimators_.front()->world;
    merged.degraded.push_back({lost.time, anew ? next.backend->trajectory().start() : range_.to,
                               fmt::format("lost: {}{}", lost.reason, found ? fmt::format("; {}", kFound) : "")});
    merged.degraded.insert(merged.degraded.end(), status.degraded.begin(), status.degraded.end());
    went_on = went_on && found && (i + 2 < estimators_.size() || status.state != RunState::lost);
  }
  if (went_on && merged.state == RunState::lost) {
    merged.state = RunState::degraded;
    merged.reason = fmt::format("lost: {}; {}", merged.reason, kFound);
  }
  if (std::ranges::none_of(has_segment, std::identity{})) {
    merged.state = RunState::failed;
    if (merged.reason.empty()) merged.reason = "no trajectory";
  }
  return merged;
}

}  // namespace evbench
