#include "bench/pipeline/backend_runner.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <set>
#include <type_traits>
#include <utility>

#include "core/geometry/in_view.hpp"
#include "core/plugin/undistort.hpp"

namespace evbench {
namespace {

template <class Value>
void append_value(std::string& bytes, const Value& value) {
  static_assert(std::is_trivially_copyable_v<Value> && sizeof(TrackId) == sizeof(double));  // no padding
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

/// Compares scale and rotation only: if both are right, a wrong translation would leave no common landmarks.
bool agree(const Similarity& a, const Similarity& b) {
  constexpr double kScale = 0.03, kAngle = 0.02;  // relative; [rad]
  return std::abs(std::log(a.scale / b.scale)) < kScale && a.T.q.angularDistance(b.T.q) < kAngle;
}

/// Transforms the feedback to another world.
void transform_feedback(BackEndFeedback& feedback, const Similarity& transform) {
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
  for (UndistortedFeature& feature : feedback.expected) feature.position = transform * feature.position;
}

}  // namespace

BackEndRunner::BackEndRunner(const MakeBackEnd& make, BackEndContext context, const Camera& camera,
                             const TimeRange& range, const PipelineOptions& options)
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
  start_estimator();
}

void BackEndRunner::start_estimator() {
  auto estimator = std::make_unique<Estimator>(estimators_.size());
  BackEndContext context = context_;
  context.publish = [this, &received = *estimator](const CausalPose& pose) { received.on_pose(pose, until_, seen_); };
  remembered_.clear();
  started_ = next_relocalisation_ = until_;
  last_found_.reset();
  estimator->backend = watch_.time([&] { return make_(context); });
  estimators_.push_back(std::move(estimator));
}

void BackEndRunner::take(const TrackBatch& raw) {
  if (stationary_.rejected()) end_estimator(*stationary_.rejected());
  observations_ += raw.observations.size();
  UndistortedBatch batch = undistort(raw, camera_);
  left_out_ += raw.observations.size() - batch.observations.size();
  stationary_.apply(batch);
  digest(batch);
  if (const Status status = estimators_.back()->status(); status.state == RunState::lost) {
    context_.event({status.time, "lost", "lost: " + status.reason});
    context_.event({until_, "reinitialised", "re-initialising with a new back-end, in a world frame of its own"});
    start_estimator();
  }
  until_ = batch.until;
  seen_ = batch.known_at();
  confirm_landmarks(batch.ended);
  Estimator& estimator = *estimators_.back();
  watch_.time([&] { estimator.backend->advance(batch); });
  relocalise();
  if (estimator.newest) estimator.covariances.take(*estimator.newest, *estimator.backend);
  work_.push_back({seen_, watch_.seconds() - std::exchange(counted_, watch_.seconds())});
}

/// The repeated observations of a rejected stationary period were wrong: the estimate ends where the period began.
void BackEndRunner::end_estimator(const StationaryDetector::Rejected& stationary) {
  Estimator& estimator = *estimators_.back();
  Status status = estimator.status();
  const double from = stationary.period.from;
  context_.event({until_, "stationary_period_rejected",
                  fmt::format("the stationary period from {:.3f} s on is rejected: the camera moved", from)});
  if (!estimator.newest || status.state >= RunState::lost) return;
  status.state = RunState::lost;
  status.reason = "the camera moved while nothing was seen";
  status.time = from;
  std::erase_if(status.degraded, [&](const DegradedSpan& span) { return span.from >= from; });
  estimator.ended = status;
  estimator.unconfirmed = stationary.surviving_tracks;
}

/// A track that ends soon after the re-initialisation is not in the new map as another scene point: its landmark in the
/// earlier map is confirmed, and can be used for relocalisation.
void BackEndRunner::confirm_landmarks(const std::vector<TrackEnd>& ended) {
  constexpr double kSoon = 0.1;  // [s], before it is a landmark of the new map
  if (until_ - started_ > kSoon) return;
  for (const auto& estimator : estimators_) {
    for (const TrackEnd& end : ended) estimator->unconfirmed.erase(end.track);
  }
}

/// Attempts are frequent while the map is recent and become rarer as it ages. A result counts if two successive
/// attempts agree, because a recent map may still change.
void BackEndRunner::relocalise() {
  constexpr double kPause = 0.1;    // [s] at least
  constexpr double kGrowth = 0.05;  // of the time since it started
  Estimator& estimator = *estimators_.back();
  if (!relocalises_ || estimators_.size() < 2 || !estimator.newest || until_ < next_relocalisation_) return;
  std::optional<Estimator::Relocalisation> found;
  for (std::size_t i = estimators_.size() - 1; i-- > 0 && !found;) {
    if (estimator.is_relocalised() && estimators_[i]->world != estimator.world) continue;
    found = estimator.find_in(*estimators_[i], context_.camera);
  }
  if (found && last_found_ && found->world == last_found_->world && agree(found->to_world, last_found_->to_world)) {
    if (!estimator.is_relocalised()) {
      context_.event(
          {until_, "relocalised", fmt::format("relocalised in the earlier world, by {} landmarks", found->landmarks)});
    }
    estimator.relocalise(*found);
    remember_landmarks();
  }
  last_found_ = found;
  next_relocalisation_ = until_ + std::max(kPause, kGrowth * (until_ - started_));
}

void BackEndRunner::remember_landmarks() {
  remembered_.clear();
  for (const auto& estimator : estimators_) {
    if (estimator->world != estimators_.back()->world) continue;
    for (const Landmark& landmark : estimator->confirmed_map()) {
      if (estimator == estimators_.back()) {
        remembered_.erase(landmark.track);
      } else {
        remembered_[landmark.track] = estimator->to_world * landmark.position;
      }
    }
  }
}

/// Adds the remembered landmarks that are in view, unless the back-end predicts them itself.
void BackEndRunner::expect_remembered(BackEndFeedback& feedback) const {
  constexpr double kSigma = 1.5;  // [px], of predictions from an aligned earlier map
  if (!feedback.newest) return;
  const SE3 T = extrapolate(*feedback.newest, until_ - feedback.newest->t).T.inverse();
  std::set<TrackId> predicted;
  for (const UndistortedFeature& feature : feedback.expected) predicted.insert(feature.track);
  for (const auto& [track, position] : remembered_) {
    const Vector3 seen = T * position;
    if (!(seen.z() > 0.0) || predicted.contains(track)) continue;
    const Vector2 pixel = context_.camera.project(seen);
    const Matrix2 covariance = kSigma * kSigma * Matrix2::Identity();
    if (in_view(context_.camera, pixel, kLensReach)) feedback.expected.push_back({track, position, pixel, covariance});
  }
}

Feedback BackEndRunner::feedback(const FeedbackNeeds& needs) {
  BackEndFeedback answer = watch_.time([&] { return estimators_.back()->backend->feedback(needs); });
  const Estimator& estimator = *estimators_.back();
  transform_feedback(answer, estimator.to_world);
  if (needs.expected) expect_remembered(answer);
  if (stationary_.is_stationary() && answer.state == TrackingState::tracking) answer.state = TrackingState::stationary;
  Feedback result;
  result.t = until_;
  result.world = estimator.world;
  result.state = answer.state;
  result.newest = answer.newest;
  result.covariance = answer.covariance;
  result.outliers = std::move(answer.outliers);
  for (const UndistortedFeature& feature : answer.expected) {
    const Matrix2 J = camera_.distortion_jacobian(feature.pixel);
    const Vector2 raw = camera_.project(camera_.pinhole.ray(feature.pixel));
    if (!camera_.contains(raw)) continue;
    result.expected.push_back({feature.track, feature.position, raw, J * feature.covariance * J.transpose()});
  }
  return result;
}

/// Hashes all of a batch at once: a call of the hash for each value would cost more than the rest of an exchange.
void BackEndRunner::digest(const UndistortedBatch& batch) {
  struct Seen {
    TrackId track;
    double t, u, v, xx, xy, yy;
  };
  struct Ended {
    TrackId track;
    double t;
  };
  for (const UndistortedObservation& z : batch.observations) {
    append_value(digested_, Seen{z.track, z.t, z.pixel.x(), z.pixel.y(), z.noise.xx(), z.noise.xy(), z.noise.yy()});
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
  result.stationary = stationary_.periods();
  result.observations = observations_;
  result.tracks_sha256 = hash_.hex();
  if (left_out_ > 0) {
    result.log.push_back(fmt::format("{} observations dropped: the lens model has no inverse there", left_out_));
  }
}

/// Makes one segment for each world. Each estimator is relocalised again by the final estimates: these determine
/// the transform between two worlds better than the maps during the run.
void BackEndRunner::add_segments(double rate, RunResult& result) {
  std::map<std::size_t, std::size_t> segment_of;  // by world
  std::vector<bool> has_segment;
  for (const auto& estimator : estimators_) {
    BackEnd& backend = *estimator->backend;
    watch_.time([&] { backend.finish(); });
    if (const Status status = backend.status(); estimator == estimators_.back() && status.state == RunState::lost) {
      context_.event({status.time, "lost", "lost: " + status.reason});
    }
    result.estimated_parameters = backend.estimated_parameters();
    result.updates.insert(result.updates.end(), backend.updates().begin(), backend.updates().end());
    for (const auto& [name, count] : backend.counters()) result.counters[name] += count;
    const std::size_t causal_world = estimator->world;
    std::vector<CausalPose> published_in_world = std::move(estimator->published_in_world);
    estimator->use_own_world();
    for (std::size_t i = estimator->number; relocalises_ && i-- > 0 && !estimator->is_relocalised();) {
      if (!has_segment[i]) continue;
      if (const auto found = estimator->find_in(*estimators_[i], context_.camera)) estimator->relocalise(*found);
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
        return causal_world != estimator->world || (status.state == RunState::lost && pose.t > status.time);
      });
      append(result.segments[entry->second], std::move(*segment), estimator->to_world, std::move(published_in_world));
    }
  }
  result.status = merged_status(has_segment);
}

/// The status of a single back-end is the run's. With several, the run was lost when the first was, and the gaps are
/// degraded spans. If all later ones were relocalised in the world of the first, the run is degraded, not lost.
Status BackEndRunner::merged_status(const std::vector<bool>& has_segment) const {
  constexpr const char* kRelocalised = "then relocalised in the same world";
  Status merged = estimators_.front()->status();
  bool all_relocalised = estimators_.size() > 1;
  for (std::size_t i = 0; i + 1 < estimators_.size(); ++i) {
    const Status lost = estimators_[i]->status();
    const Estimator& next = *estimators_[i + 1];
    const Status status = next.status();
    const bool started = has_segment[i + 1], relocalised = started && next.world == estimators_.front()->world;
    const std::string suffix = relocalised ? fmt::format("; {}", kRelocalised) : "";
    merged.degraded.push_back({lost.time, started ? next.backend->trajectory().start() : range_.to,
                               fmt::format("lost: {}{}", lost.reason, suffix)});
    merged.degraded.insert(merged.degraded.end(), status.degraded.begin(), status.degraded.end());
    all_relocalised = all_relocalised && relocalised && (i + 2 < estimators_.size() || status.state != RunState::lost);
  }
  if (all_relocalised && merged.state == RunState::lost) {
    merged.state = RunState::degraded;
    merged.reason = fmt::format("lost: {}; {}", merged.reason, kRelocalised);
  }
  if (std::ranges::none_of(has_segment, std::identity{})) {
    merged.state = RunState::failed;
    if (merged.reason.empty()) merged.reason = "no trajectory";
  }
  return merged;
}

}  // namespace evbench
