#include "bench/micro/track_problem.hpp"

#include <algorithm>
#include <cmath>

#include "core/simulation/motion.hpp"
#include "core/simulation/random.hpp"
#include "core/support/index.hpp"

namespace evbench {
namespace {

constexpr double kWidth = 240.0, kHeight = 180.0, kBorder = 4.0;

class Generator {
 public:
  explicit Generator(const TrackProblemOptions& options) : options_(options), random_(options.seed) {
    MotionOptions motion;
    motion.kind = "smooth_random";
    motion.amplitude = 0.9;
    motion.rotation_amplitude = 0.22;
    motion.max_frequency = 0.4;
    motion_ = make_motion(motion, options.duration + 1.0, options.seed, ".", "motion");
    problem_.camera = {199.0, 199.0, 120.0, 90.0};
    problem_.qc = Vector6::Constant(0.2);
  }

  Problem run() {
    const int states = static_cast<int>(std::lround(options_.duration * options_.state_rate)) + 1;
    for (int k = 0; k < states; ++k) problem_.states.push_back(state(k / options_.state_rate));
    problem_.pose_priors.push_back({0, problem_.states.front().T, Vector6::Constant(0.005)});
    problem_.velocity_priors.push_back({0, problem_.states.front().velocity, Vector6::Constant(0.05)});
    for (int i = 0; i < options_.tracks; ++i) {
      double t = random_.uniform(0.0, 0.02);
      while (t < options_.duration) t = add_track(t) + random_.uniform(0.0, 0.02);
    }
    return problem_;
  }

 private:
  ControlState state(double t) const {
    constexpr double kStep = 1e-5;
    const double from = std::max(0.0, t - kStep), to = t + kStep;
    return {t, motion_(t), se3::log(motion_(from).inverse() * motion_(to)) / (to - from)};
  }

  bool sees(const Vector3& q, double border) const {
    if (!(q.z() > 0.1)) return false;
    const Vector2 pixel = problem_.camera.project(q);
    return pixel.x() >= border && pixel.y() >= border && pixel.x() < kWidth - border && pixel.y() < kHeight - border;
  }

  /// Returns when it ends.
  double add_track(double t) {
    const int landmark = choose_landmark(motion_(t));
    const double end = std::min(options_.duration, t + random_.uniform(options_.shortest, options_.longest));
    const double rate = random_.uniform(options_.slowest, options_.fastest);
    t += random_.uniform(0.0, 1.0 / rate);
    for (; t <= end; t += random_.uniform(0.4, 1.6) / rate) {
      const Vector3 q = motion_(t).inverse() * truth_[index(landmark)];
      if (!sees(q, kBorder)) break;
      const Vector2 noise = random_.normal2();
      problem_.observations.push_back(
          {t, landmark, problem_.camera.project(q) + options_.noise * noise, options_.noise});
    }
    return t;
  }

  int choose_landmark(const SE3& T) {
    if (!truth_.empty() && random_.uniform() < options_.again) {
      for (int attempt = 0; attempt < 50; ++attempt) {
        const std::size_t candidate = random_.index(truth_.size());
        if (sees(T.inverse() * truth_[candidate], 10.0)) return static_cast<int>(candidate);
      }
    }
    const PinholeCamera& camera = problem_.camera;
    const double u = random_.uniform(15.0, kWidth - 15.0), v = random_.uniform(15.0, kHeight - 15.0);
    const double depth = random_.uniform(options_.depth_near, options_.depth_far);
    const Vector3 ray((u - camera.cx) / camera.fx, (v - camera.cy) / camera.fy, 1.0);
    const double error = 1.0 + 0.1 * std::clamp(random_.normal(), -3.0, 3.0);
    const Vector3 guess = T * Vector3(error * depth * ray);
    const int index = static_cast<int>(truth_.size());
    truth_.push_back(T * Vector3(depth * ray));
    problem_.landmarks.push_back(guess);
    problem_.landmark_priors.push_back({index, guess, 1.0});
    return index;
  }

  TrackProblemOptions options_;
  Random random_;
  Motion motion_;
  Problem problem_;
  std::vector<Vector3> truth_;
};

}  // namespace

Problem make_track_problem(const TrackProblemOptions& options) { return Generator(options).run(); }

}  // namespace evbench
