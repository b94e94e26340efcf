// The back-end NAME for evbench: a small one to start from. Every `period` it estimates a pose from the landmarks in
// view, then triangulates new landmarks from the poses. The initial map comes from evbench's Initialiser.
#include <algorithm>
#include <chrono>
#include <deque>
#include <evbench/plugin.hpp>
#include <map>

namespace {

using namespace evbench;

struct View {
  double t = 0.0;  // [s]
  SE3 T;           // T_world_camera
  std::map<TrackId, Vector2> pixels;
};
using Points = std::map<TrackId, Vector3>;  // world frame

class ClassName : public evbench::BackEnd {
 public:
  struct Options {
    double period = 0.05, window = 0.06, huber_px = 1.5, outlier_px = 5.0;
    double clear_parallax_deg = 8.0;
    int views = 30, min_landmarks = 8;
    InitialiserOptions initialiser;

    void declare(OptionSet& set) {
      set.add("period", period, "time between two poses [s]").range(0.001, 1.0);
      set.add("window", window, "time over which a track's position is interpolated from its observations [s]")
          .range(0.001, 1.0);
      set.add("huber_px", huber_px, "error above which an observation has less weight [px]").above(0.0);
      set.add("outlier_px", outlier_px, "error above which a track is dropped as an outlier [px]").above(0.0);
      set.add("clear_parallax_deg", clear_parallax_deg,
              "parallax above which the better of two initial maps is accepted [deg]")
          .range(0.0);
      set.add("views", views, "views from which landmarks are triangulated").range(2);
      set.add("min_landmarks", min_landmarks, "landmarks in view that a pose needs").range(4);
      set.group("initialiser", initialiser, "the initial map");
    }
  };

  ClassName(const Options& options, const BackEndContext& context)
      : options_(options),
        context_(context),
        initialiser_(options.initialiser, context.camera),
        monitor_(context.patience) {}

  void advance(const UndistortedBatch& batch) override {
    until_ = batch.until;
    if (monitor_.lost()) return;
    tracks_.add(batch.observations);
    if (!next_ && !batch.observations.empty()) next_ = batch.observations.front().t + options_.window;
    // A view needs observations on both sides of its time.
    while (next_ && *next_ + 0.5 * options_.window <= until_ && !monitor_.lost()) {
      step(*next_);
      *next_ += options_.period;
    }
  }

  BackEndFeedback feedback(const FeedbackNeeds& needs) override {
    BackEndFeedback result;
    result.state = monitor_.state();
    result.outliers = std::exchange(outliers_, {});
    if (trajectory_.empty() || monitor_.lost()) return result;
    const View& newest = views_.back();
    result.newest = ControlState{newest.t, newest.T, velocity_};
    const SE3 T_camera_world = predict(until_).inverse();
    for (const auto& [track, pixel] : newest.pixels) {
      const auto point = points_.find(track);
      if (!needs.expected || point == points_.end()) continue;
      const Vector3 p = T_camera_world * point->second;
      if (p.z() > 0.0)
        result.expected.push_back({track, point->second, context_.camera.project(p), Matrix2::Identity()});
    }
    return result;
  }

  void finish() override {
    if (trajectory_.empty()) monitor_.fail(until_, "never initialised: " + waiting_for_);
  }

  Status status() const override { return monitor_.status(); }
  PoseTrajectory trajectory() const override { return PoseTrajectory(trajectory_); }
  std::span<const UpdateRecord> updates() const override { return updates_; }
  std::vector<Landmark> map() const override {
    std::vector<Landmark> result;
    for (const auto& [track, point] : points_) result.push_back({track, point});
    return result;
  }

 private:
  Options options_;
  BackEndContext context_;
  Initialiser initialiser_;
  TrackingMonitor monitor_;
  TrackBuffer tracks_;
  std::optional<double> next_;  // time of the next view [s]
  double until_ = 0.0;
  std::deque<View> views_;  // the newest ones; before initialisation those since the initialiser's first view
  Points points_;
  Vector6 velocity_ = Vector6::Zero();
  std::vector<StampedPose> trajectory_;
  std::vector<UpdateRecord> updates_;
  std::vector<TrackId> outliers_;
  std::string waiting_for_ = "no observations";

  SE3 predict(double t) const { return views_.back().T * se3::exp((t - views_.back().t) * velocity_); }

  void step(double t) {
    const auto start = std::chrono::steady_clock::now();
    View view{t, {}, {}};
    for (const TrackId track : tracks_.alive(t, 0.5 * options_.window)) {
      if (const auto pixel = tracks_.position(track, t, options_.window)) view.pixels[track] = *pixel;
    }
    const bool known = trajectory_.empty() ? find_initial_map(std::move(view)) : follow(std::move(view));
    if (known) {
      trajectory_.push_back({t, views_.back().T});
      context_.publish({trajectory_.back(), t, velocity_});
    }
    if (!trajectory_.empty()) tracks_.forget_ended_before(t - options_.window);
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
    const auto count = static_cast<int>(views_.empty() ? 0 : views_.back().pixels.size());
    updates_.push_back({t, seconds.count(), 1, static_cast<int>(points_.size()), count, kIterations, std::nullopt});
  }

  static constexpr int kIterations = 8;

  /// Gauss-Newton on the reprojection errors with a Huber loss and fixed landmarks; returns the errors [px] by track.
  std::map<TrackId, double> locate(View& view, const Points& points) const {
    std::map<TrackId, double> errors;
    for (int i = 0; i < kIterations; ++i) {
      Matrix6 H = 1e-6 * Matrix6::Identity();
      Vector6 b = Vector6::Zero();
      const SE3 T_camera_world = view.T.inverse();
      errors.clear();
      for (const auto& [track, pixel] : view.pixels) {
        const auto point = points.find(track);
        if (point == points.end()) continue;
        const Vector3 p = T_camera_world * point->second;
        if (p.z() < 0.01) continue;
        const Vector2 r = context_.camera.project(p) - pixel;
        Eigen::Matrix<double, 3, 6> dp;  // of the point in the camera, for T Exp(δ)
        dp << so3::hat(p), -Matrix3::Identity();
        const Matrix26 J = context_.camera.project_jacobian(p) * dp;
        const double weight = std::min(1.0, options_.huber_px / r.norm());
        H += weight * J.transpose() * J;
        b -= weight * J.transpose() * r;
        errors[track] = r.norm();
      }
      view.T = view.T * se3::exp(H.ldlt().solve(b));
    }
    return errors;
  }

  /// Triangulates a track from the views that observe it.
  Triangulation triangulate_from(const std::deque<View>& views, TrackId track) const {
    std::vector<SE3> poses;
    std::vector<Vector2> pixels;
    for (const View& view : views) {
      const auto pixel = view.pixels.find(track);
      if (pixel == view.pixels.end()) continue;
      poses.push_back(view.T);
      pixels.push_back(pixel->second);
    }
    return triangulate(poses, pixels, context_.camera, {2.0, options_.outlier_px, 10});
  }

  /// An initial guess after alternating refinement of poses and landmarks, and its mean error.
  struct Trial {
    std::deque<View> views;
    Points points;
    double error = 0.0;  // [px]
  };

  Trial refine(const InitialGuess& guess) const {
    Trial trial{views_, {}, 0.0};
    for (const Landmark& landmark : guess.landmarks) trial.points[landmark.track] = landmark.position;
    for (View& view : trial.views) {
      view.T = se3::exp((view.t - guess.t0) / (guess.t1 - guess.t0) * se3::log(guess.T1));
    }
    for (int round = 0; round < 10; ++round) {
      double sum = 0.0, count = 0.0;
      for (std::size_t i = 1; i < trial.views.size(); ++i) {  // the first one fixes the world frame
        for (const auto& [track, error] : locate(trial.views[i], trial.points)) {
          sum += std::min(error, options_.outlier_px);
          count += 1.0;
        }
      }
      trial.error = count > 0.0 ? sum / count : options_.outlier_px;
      for (auto& [track, point] : trial.points) {
        if (const auto better = triangulate_from(trial.views, track); better.ok()) point = better.point;
      }
    }
    return trial;
  }

  bool find_initial_map(View view) {
    const double t = view.t;
    views_.push_back(std::move(view));
    const Initialiser::Attempt attempt = initialiser_.attempt(tracks_, t);
    waiting_for_ = attempt.reason;
    const double first = initialiser_.reference_time().value_or(t + 1.0);
    while (!views_.empty() && views_.front().t < first) views_.pop_front();
    std::vector<Trial> trials;
    for (const InitialGuess& guess : attempt.candidates) {
      Trial trial = refine(guess);
      if (trial.error > 0.5 * options_.outlier_px) continue;
      const bool known = std::ranges::any_of(
          trials, [&](const Trial& other) { return same_motion(other.views.back().T, trial.views.back().T); });
      if (!known) trials.push_back(std::move(trial));
    }
    std::ranges::sort(trials, {}, &Trial::error);
    // A flat or distant scene allows two motions with similar errors; many views decide between them.
    const bool clear =
        trials.size() == 1 || (trials.size() > 1 && trials[1].error > 1.1 * trials[0].error) ||
        (!trials.empty() && attempt.candidates.front().median_parallax_deg > options_.clear_parallax_deg);
    if (!clear) {
      if (!attempt.candidates.empty()) waiting_for_ = "no motion explains the first views better than all others";
      return false;
    }
    views_ = std::move(trials.front().views);
    points_ = std::move(trials.front().points);
    for (const View& v : views_) trajectory_.push_back({v.t, v.T});
    trajectory_.pop_back();  // the newest one follows in step()
    monitor_.observe(t, t, TrackingMonitor::Support::full);
    update_map();
    context_.event({t, "initialised", "initial map: " + std::to_string(points_.size()) + " landmarks"});
    return true;
  }

  bool follow(View view) {
    view.T = predict(view.t);
    const double before = trajectory_.back().t;
    int good = 0;
    std::vector<TrackId> bad;
    for (const auto& [track, error] : locate(view, points_)) {
      if (error < options_.outlier_px) {
        ++good;
      } else {
        bad.push_back(track);
      }
    }
    using Support = TrackingMonitor::Support;
    const bool located = good >= options_.min_landmarks && good > static_cast<int>(bad.size());
    monitor_.observe(before, view.t, located ? Support::full : Support::none,
                     "landmarks in view: " + std::to_string(good));
    if (!located) return false;
    for (const TrackId track : bad) {
      tracks_.remove(track);
      points_.erase(track);
      view.pixels.erase(track);
    }
    outliers_.insert(outliers_.end(), bad.begin(), bad.end());
    velocity_ = se3::log(views_.back().T.inverse() * view.T) / (view.t - views_.back().t);
    views_.push_back(std::move(view));
    while (static_cast<int>(views_.size()) > options_.views) views_.pop_front();
    update_map();
    return true;
  }

  /// Triangulates new landmarks, and refines those whose observations are all in the views.
  void update_map() {
    for (const auto& [track, pixel] : views_.back().pixels) {
      if (views_.front().pixels.contains(track) && points_.contains(track)) continue;
      if (const auto landmark = triangulate_from(views_, track); landmark.ok()) points_[track] = landmark.point;
    }
  }
};

const Registration<evbench::BackEnd, ClassName> registration("NAME", "template: poses and landmarks in turn");

}  // namespace
