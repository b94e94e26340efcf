// The source NAME for evbench: a small one to start from. A camera moves on a circle in front of random points; it has
// ground truth and true tracks. A source that reads a recording would also implement all_events() and files().
#include <algorithm>
#include <cmath>
#include <evbench/plugin.hpp>

namespace {

using namespace evbench;

class ClassName : public evbench::Source {
 public:
  struct Options {
    double duration = 5.0, radius = 0.3, period = 4.0, rate = 50.0, noise = 0.5;
    int points = 60;

    void declare(OptionSet& set) {
      set.add("duration", duration, "length of the sequence [s]").range(0.1, 1000.0);
      set.add("radius", radius, "radius of the circle [m]").above(0.0);
      set.add("period", period, "time of one round [s]").above(0.0);
      set.add("rate", rate, "observations of a point per second [Hz]").range(1.0, 1000.0);
      set.add("noise", noise, "standard deviation of each coordinate of an observation [px]").range(0.0);
      set.add("points", points, "number of points").range(1);
    }
  };

  ClassName(const Options& options, const SourceContext& context) : options_(options) {
    camera_.pinhole = {200.0, 200.0, 119.5, 89.5};
    camera_.width = 240;
    camera_.height = 180;
    std::vector<StampedPose> poses;
    for (int i = 0; 0.005 * i <= options.duration; ++i) poses.push_back({0.005 * i, pose(0.005 * i)});
    ground_truth_ = PoseTrajectory(std::move(poses));
    observe_points(context.seed);
  }

  const Camera& camera() const override { return camera_; }
  TimeRange time_range() const override { return {0.0, options_.duration}; }
  const PoseTrajectory& ground_truth() const override { return ground_truth_; }
  std::optional<std::span<const TrackObservation>> true_tracks() const override { return tracks_; }
  std::vector<std::string> remarks() const override {
    return {std::to_string(tracks_.size()) + " observations of " + std::to_string(options_.points) + " points"};
  }

 private:
  Options options_;
  Camera camera_;
  PoseTrajectory ground_truth_;
  std::vector<TrackObservation> tracks_;

  /// T_world_camera: on the circle, with a small rotation about the optical axis.
  SE3 pose(double t) const {
    const double angle = 2.0 * M_PI * t / options_.period;
    Vector6 roll = Vector6::Zero();
    roll.z() = 0.1 * std::sin(angle);
    const Vector3 p = options_.radius * Vector3(std::cos(angle), std::sin(angle), 0.0);
    return SE3{Eigen::Quaterniond::Identity(), p} * se3::exp(roll);
  }

  void observe_points(std::uint64_t seed) {
    Random random(seed);
    TrackId track = 0;  // a point that returns into view is a new track
    for (int i = 0; i < options_.points; ++i, ++track) {
      const Vector3 point = random.uniform3({-1.0, -0.8, 1.5}, {1.0, 0.8, 2.5});
      const double first = random.uniform() / options_.rate;  // each point has its own observation times
      bool seen = false;
      for (double t = first; t <= options_.duration; t += 1.0 / options_.rate) {
        const Vector2 noise = options_.noise * random.normal2();
        const Vector2 pixel = camera_.project(pose(t).inverse() * point) + noise;
        if (camera_.contains(pixel)) {
          tracks_.push_back({track, t, pixel, std::max(options_.noise, 0.1)});
        } else if (seen) {
          ++track;
        }
        seen = camera_.contains(pixel);
      }
    }
    std::ranges::stable_sort(tracks_, {}, &TrackObservation::t);
  }
};

const Registration<evbench::Source, ClassName> registration("NAME", "template: a camera moves on a circle");

}  // namespace
