#include "backends/bundle_adjustment/bundle_adjustment.hpp"

#include <Eigen/Geometry>
#include <cmath>
#include <limits>

#include "core/data/calib.hpp"
#include "core/data/tracks.hpp"
#include "core/data/tum.hpp"
#include "core/plugin/undistort.hpp"
#include "core/support/index.hpp"
#include "core/testing/catch2.hpp"
#include "core/testing/data.hpp"
#include "core/testing/point_scene.hpp"

using namespace evbench;
using evbench::bundle_adjustment::BundleAdjustment;
using evbench::bundle_adjustment::Options;
using evbench::testing::davis;
using evbench::testing::PointScene;

namespace {

using Motion = SE3 (*)(double t);

SE3 weaving(double t) {
  Vector6 xi;
  xi << 0.05 * std::sin(1.3 * t), 0.08 * std::sin(t), 0.1 * std::sin(0.7 * t), 0.5 * std::sin(t),
      0.3 * std::sin(1.7 * t), 0.2 * std::sin(0.9 * t);
  return se3::exp(xi);
}
SE3 resting(double) { return {}; }
SE3 rotating(double t) { return se3::exp((Vector6() << 0.0, 0.1 * std::sin(2.0 * t), 0.3 * t, 0, 0, 0).finished()); }

struct Simulation {
  PointScene scene = PointScene::volume;
  Motion motion = weaving;
  double duration = 4.0, noise = 0.3, outlier_share = 0.0;
  double stated_noise = 0.0;  ///< sigma of the observations; 0: the noise
  double blackout_from = 0.0, blackout_to = 0.0;
  bool new_tracks_after_blackout = false;
};

/// Observations of fifty points at 100 Hz, each at its own times, in time order.
std::vector<UndistortedObservation> simulate(const Simulation& simulation) {
  Random random(4);
  std::vector<UndistortedObservation> result;
  TrackId id = 0;
  for (const Vector3& point : testing::scene_points(simulation.scene, 50, random, 2.0)) {
    const bool outlier = random.uniform(0.0, 1.0) < simulation.outlier_share;
    const Vector2 drift = random.uniform2({-25, -25}, {25, 25});
    for (double t = random.uniform(0.0, 0.01); t <= simulation.duration; t += random.uniform(0.008, 0.012)) {
      if (t > simulation.blackout_from && t < simulation.blackout_to) continue;
      Vector2 pixel =
          davis().project(simulation.motion(t).inverse() * point) + testing::noise(simulation.noise, random);
      if (outlier) pixel += t * drift;
      const bool renamed = simulation.new_tracks_after_blackout && t >= simulation.blackout_to;
      result.push_back({renamed ? id + 1000 : id, t, pixel,
                        simulation.stated_noise > 0.0 ? simulation.stated_noise : std::max(0.1, simulation.noise)});
    }
    ++id;
  }
  std::sort(result.begin(), result.end(), [](const UndistortedObservation& a, const UndistortedObservation& b) {
    return a.t != b.t ? a.t < b.t : a.track < b.track;
  });
  return result;
}

/// `causal`: takes the causal poses.
BundleAdjustment make(const PinholeCamera& camera = davis(), const Options& options = {},
                      std::vector<StampedPose>* causal = nullptr) {
  BackEndContext context;
  context.camera = camera;
  if (causal != nullptr) {
    context.publish = [causal](const CausalPose& pose) {
      if (causal->empty() || pose.t > causal->back().t) causal->push_back(pose);
    };
  }
  return BundleAdjustment(options, context);
}

void feed(BundleAdjustment& backend, const std::vector<UndistortedObservation>& observations) {
  UndistortedBatch batch;
  for (std::size_t begin = 0, end = 0; begin < observations.size(); begin = end) {
    const double t = observations[begin].t + 0.01;
    while (end < observations.size() && observations[end].t <= t) ++end;
    const auto part = std::span(observations).subspan(begin, end - begin);
    batch.observations.assign(part.begin(), part.end());
    batch.until = t;
    backend.advance(batch);
  }
  backend.finish();
}

/// Root mean square distance from the truth after Sim(3) alignment.
template <class Truth>
double ate(const PoseTrajectory& estimate, const Truth& truth) {
  const auto n = static_cast<Eigen::Index>(estimate.size());
  Eigen::Matrix3Xd from(3, n), to(3, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const StampedPose& pose = estimate.poses()[index(i)];
    from.col(i) = pose.T.p;
    to.col(i) = truth(pose.t).p;
  }
  const Eigen::Matrix4d S = Eigen::umeyama(from, to, true);
  const Eigen::Matrix3Xd aligned = (S.topLeftCorner<3, 3>() * from).colwise() + S.topRightCorner<3, 1>();
  return std::sqrt((aligned - to).squaredNorm() / static_cast<double>(n));
}

bool finite(const PoseTrajectory& trajectory) {
  return std::all_of(trajectory.poses().begin(), trajectory.poses().end(),
                     [](const StampedPose& pose) { return pose.T.p.allFinite() && pose.T.q.coeffs().allFinite(); });
}

}  // namespace

TEST_CASE("a simulated motion is recovered, in front of a volume and of a plane", "[slow]") {
  for (const PointScene scene : {PointScene::volume, PointScene::plane}) {
    Simulation simulation;
    simulation.scene = scene;
    std::vector<StampedPose> causal;
    BundleAdjustment backend = make(davis(), {}, &causal);
    feed(backend, simulate(simulation));
    CHECK(backend.status().state == RunState::ok);
    CHECK(backend.trajectory().start() < 0.1);
    CHECK(backend.trajectory().end() > 3.9);
    CHECK(ate(backend.trajectory(), simulation.motion) < 0.01);
    CHECK(ate(PoseTrajectory(causal), simulation.motion) < 0.03);
    CHECK(backend.map().size() == 50);
    CHECK(backend.updates().size() >= 80);
  }
}

TEST_CASE("outlier tracks are removed and do no harm") {
  Simulation simulation;
  simulation.outlier_share = 0.15;
  simulation.noise = 0.7;
  BundleAdjustment backend = make();
  feed(backend, simulate(simulation));
  CHECK(backend.status().state == RunState::ok);
  CHECK(ate(backend.trajectory(), simulation.motion) < 0.02);
  CHECK(backend.map().size() < 50);
}

TEST_CASE("batches by count give about the same as batches by duration") {
  Options options;
  options.batch_observations = 250;
  const Simulation simulation;
  BundleAdjustment backend = make(davis(), options);
  feed(backend, simulate(simulation));
  CHECK(backend.trajectory().size() > 70);
  CHECK(ate(backend.trajectory(), simulation.motion) < 0.01);
}

TEST_CASE("batches by motion give about the same as batches by duration") {
  Options options;
  options.batch_motion = 3.0;
  options.batch_duration = 0.4;
  const Simulation simulation;
  BundleAdjustment backend = make(davis(), options);
  feed(backend, simulate(simulation));
  CHECK(backend.trajectory().size() > 20);
  CHECK(ate(backend.trajectory(), simulation.motion) < 0.01);
}

TEST_CASE("estimated noise makes up for sigmas that are wrong by a factor", "[slow]") {
  Simulation simulation;
  simulation.noise = 0.5;
  Options options;
  options.common_noise_px = 0.0;
  const auto error = [&](double stated, bool learn) {
    simulation.stated_noise = stated;
    options.learn_noise = learn;
    BundleAdjustment backend = make(davis(), options);
    feed(backend, simulate(simulation));
    return ate(backend.trajectory(), simulation.motion);
  };
  const double right = error(0.5, false);
  CHECK(error(0.05, true) < 1.1 * right);
  CHECK(error(0.05, true) <= error(0.05, false));
  CHECK(error(2.0, true) < 1.1 * right);
}

TEST_CASE("a batch's pose is published when the batch ends, and the window's poses are published again") {
  BackEndContext context;
  context.camera = davis();
  std::vector<CausalPose> published;
  context.publish = [&](const CausalPose& pose) { published.push_back(pose); };
  Options options;
  options.batch_duration = 0.1;
  options.window = 5;
  BundleAdjustment backend(options, context);
  feed(backend, simulate({}));
  double newest = 0.0;
  int improved = 0;
  for (const CausalPose& pose : published) {
    if (pose.t > newest) {
      CHECK(*pose.known_at - pose.t == Approx(0.05).margin(0.01));
      CHECK(pose.velocity);
    } else {
      ++improved;
      CHECK(*pose.known_at > newest);
    }
    newest = std::max(newest, pose.t);
  }
  CHECK(improved > 3 * 30);
}

TEST_CASE("the same observations give the same trajectory to the last bit", "[slow]") {
  const auto observations = simulate({});
  BundleAdjustment a = make(), b = make();
  feed(a, observations);
  feed(b, observations);
  REQUIRE(a.trajectory().size() == b.trajectory().size());
  for (std::size_t i = 0; i < a.trajectory().size(); ++i) {
    CHECK(a.trajectory().poses()[i].T.p == b.trajectory().poses()[i].T.p);
    CHECK(a.trajectory().poses()[i].T.q.coeffs() == b.trajectory().poses()[i].T.q.coeffs());
  }
}

TEST_CASE("no observations, one track, and few tracks end as failed with a reason") {
  std::vector<UndistortedObservation> one, few;
  for (const UndistortedObservation& z : simulate({})) {
    if (z.track == 7) one.push_back(z);
    if (z.track < 7) few.push_back(z);
  }
  for (const auto& observations : {std::vector<UndistortedObservation>{}, one, few}) {
    std::vector<StampedPose> causal;
    BundleAdjustment backend = make(davis(), {}, &causal);
    feed(backend, observations);
    CHECK(backend.status().state == RunState::failed);
    CHECK_FALSE(backend.status().reason.empty());
    CHECK(backend.trajectory().empty());
    CHECK(causal.empty());
    CHECK(backend.map().empty());
  }
}

TEST_CASE("a camera at rest and a pure rotation never initialise and report why") {
  for (const Motion motion : {resting, rotating}) {
    Simulation simulation;
    simulation.motion = motion;
    BundleAdjustment backend = make();
    feed(backend, simulate(simulation));
    CHECK(backend.status().state == RunState::failed);
    CHECK(backend.status().reason.find("never initialised") == 0);
  }
}

TEST_CASE("a blackout that the tracks survive is reported as degraded and costs nothing else") {
  Simulation simulation;
  simulation.blackout_from = 2.0;
  simulation.blackout_to = 2.4;
  BundleAdjustment backend = make();
  feed(backend, simulate(simulation));
  CHECK(backend.trajectory().end() > 3.9);
  CHECK(ate(backend.trajectory(), simulation.motion) < 0.01);
  CHECK(backend.trajectory().pose(2.2));
  CHECK(backend.status().state == RunState::degraded);
  REQUIRE(backend.status().degraded.size() == 1);
  CHECK(backend.status().degraded.front().from == Approx(2.0).margin(0.06));
  CHECK(backend.status().degraded.front().to == Approx(2.4).margin(0.06));
}

TEST_CASE("after a blackout that ends all tracks a new map is initialised at the predicted pose") {
  Simulation simulation;
  simulation.blackout_from = 2.0;
  simulation.blackout_to = 2.2;
  simulation.new_tracks_after_blackout = true;
  BundleAdjustment backend = make();
  feed(backend, simulate(simulation));
  CHECK(backend.status().state == RunState::degraded);
  REQUIRE_FALSE(backend.status().degraded.empty());
  CHECK(backend.status().degraded.front().from == Approx(2.0).margin(0.06));
  CHECK(backend.status().degraded.front().to == Approx(2.2).margin(0.06));
  CHECK(backend.trajectory().end() > 3.9);
  CHECK(finite(backend.trajectory()));
  CHECK(ate(backend.trajectory(), simulation.motion) < 0.15);
}

TEST_CASE("when tracks run out for good the run is lost at that time and keeps its trajectory") {
  std::vector<UndistortedObservation> observations = simulate({});
  std::erase_if(observations, [](const UndistortedObservation& z) { return z.t > 2.0 && z.track > 3; });
  BundleAdjustment backend = make();
  feed(backend, observations);
  CHECK(backend.status().state == RunState::lost);
  CHECK(backend.status().time == Approx(2.0).margin(0.1));
  CHECK(backend.trajectory().end() == Approx(2.0).margin(0.1));
  CHECK(ate(backend.trajectory(), weaving) < 0.01);
}

TEST_CASE("absurd observations never give a pose that is not finite") {
  std::vector<UndistortedObservation> observations = simulate({});
  for (std::size_t i = 0; i < observations.size(); ++i) {
    if (observations[i].track % 3 == 0) observations[i].pixel *= 1e6;
    if (observations[i].t > 2.0) observations[i].pixel = Vector2(120, 90);
  }
  std::vector<StampedPose> causal;
  BundleAdjustment backend = make(davis(), {}, &causal);
  feed(backend, observations);
  CHECK(finite(backend.trajectory()));
  CHECK(finite(PoseTrajectory(causal)));
}

TEST_CASE("on the real tracks of poster_translation batches of 50 and 100 ms stay below 8 mm") {
  const auto file = testing::data_file("poster_translation/tracks_eklt.txt");
  if (!file) return;
  const Camera camera = read_calib(*testing::data_file("poster_translation/calib.txt"), 240, 180);
  const PoseTrajectory truth = read_tum(*testing::data_file("poster_translation/groundtruth.txt"));
  std::vector<UndistortedObservation> observations;
  for (const TrackObservation& z : read_tracks(*file, 240, 180).observations) {
    if (z.t > 3.05) break;
    observations.push_back(undistort(z, camera).value());
  }
  for (const double duration : {0.05, 0.1}) {
    Options options;
    options.batch_duration = duration;
    BundleAdjustment backend = make(camera.pinhole, options);
    feed(backend, observations);
    CHECK(backend.status().state == RunState::ok);
    CHECK(ate(backend.trajectory(), [&](double t) { return truth.pose(t).value(); }) < 0.008);
  }
}
