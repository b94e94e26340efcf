#include "core/simulation/track_simulator.hpp"

#include <map>

#include "core/testing/catch2.hpp"

using namespace evbench;

namespace {

Camera small_camera() {
  Camera camera;
  camera.pinhole = {200.0, 200.0, 119.5, 89.5};
  camera.width = 240;
  camera.height = 180;
  return camera;
}

struct Sequence {
  Camera camera = small_camera();
  double duration = 20.0;
  MotionOptions motion_options;
  SceneOptions scene_options;
  TrackOptions options;
  Motion motion;
  SimulatedTracks result;

  const Sequence& run(std::uint64_t seed = 1) {
    motion = make_motion(motion_options, duration, seed, "", "motion");
    Scene scene(scene_options, camera, motion, duration, Random(seed, 1));
    result = simulate_tracks(options, camera, motion, scene, duration, seed, "tracks");
    return *this;
  }

  SimulatedTracks::Track track(const TrackObservation& o) const { return result.tracks.at(std::size_t(o.track)); }
  Vector2 residual(const TrackObservation& o) const {
    return o.pixel - camera.project(motion(o.t).inverse() * track(o).point);
  }
  std::map<TrackId, std::vector<TrackObservation>> by_track() const {
    std::map<TrackId, std::vector<TrackObservation>> map;
    for (const TrackObservation& o : result.observations) map[o.track].push_back(o);
    return map;
  }
};

double rms(const Sequence& s, TrackKind kind) {
  double sum = 0.0;
  int count = 0;
  for (const TrackObservation& o : s.result.observations) {
    if (s.track(o).kind != kind) continue;
    sum += s.residual(o).squaredNorm();
    count += 2;
  }
  return std::sqrt(sum / count);
}

}  // namespace

TEST_CASE("Inliers reproject through the ground truth at the noise level in every scene and motion", "[slow]") {
  Sequence s;
  s.scene_options.kind = GENERATE("volume", "plane", "boxes", "frustum");
  s.motion_options.kind = GENERATE("robot_arm", "smooth_random");
  s.run();
  CHECK(rms(s, TrackKind::inlier) == Approx(s.options.noise).epsilon(0.02));
}

TEST_CASE("A lens is applied to the raw pixels") {
  Sequence s;
  s.camera.distortion = DistortionModel::radial_tangential;
  s.camera.coefficients << -0.3684, 0.1509, -0.0003, -0.00076, 0.0;
  s.run();
  CHECK(rms(s, TrackKind::inlier) == Approx(s.options.noise).epsilon(0.02));
}

TEST_CASE("Observations are in time order, inside the sequence and near the image, with ids in order of birth") {
  Sequence s;
  s.run();
  double before = 0.0;
  for (const TrackObservation& o : s.result.observations) {
    REQUIRE(o.t >= before);
    REQUIRE(o.t <= s.duration);
    REQUIRE(s.camera.contains(o.pixel));
    REQUIRE(o.noise.sigma() == Approx(0.7));
    before = o.t;
  }
  CHECK(s.by_track().size() == s.result.tracks.size());
}

TEST_CASE("Lifetimes, rates and the number of tracks alive are as asked for") {
  Sequence s;
  s.options.alive = 50;
  s.options.lifetime = {0.5, 1.0};
  s.options.rate = {80.0, 120.0};
  s.run();
  double alive = 0.0, updates = 0.0;
  for (const auto& [id, track] : s.by_track()) {
    const double life = track.back().t - track.front().t;
    REQUIRE(life <= 1.0);
    alive += life / s.duration;
    updates += double(track.size() - 1);
    for (std::size_t i = 1; i < track.size(); ++i) {
      const double gap = track[i].t - track[i - 1].t;
      REQUIRE(gap >= 0.4 / 120.0 - 2e-6);
      REQUIRE(gap <= 1.6 / 80.0 + 2e-6);
    }
  }
  CHECK(alive > 45.0);
  CHECK(alive < 50.0);
  CHECK(updates / (alive * s.duration) == Approx(100.0).epsilon(0.05));
}

TEST_CASE("The shares of outlying and drifting tracks are as asked for, and they leave their points") {
  Sequence s;
  s.options.outlier_share = 0.2;
  s.options.drift_share = 0.1;
  s.run();
  const auto share = [&](TrackKind kind) {
    return double(std::ranges::count(s.result.tracks, kind, &SimulatedTracks::Track::kind)) /
           double(s.result.tracks.size());
  };
  CHECK(share(TrackKind::outlier) == Approx(0.2).margin(0.04));
  CHECK(share(TrackKind::drift) == Approx(0.1).margin(0.04));
  CHECK(rms(s, TrackKind::inlier) == Approx(s.options.noise).epsilon(0.02));
  CHECK(rms(s, TrackKind::outlier) > 10.0);
  CHECK(rms(s, TrackKind::drift) > 2.0);
}

TEST_CASE("Quantised pixels are multiples of the step, and sigma says so") {
  Sequence s;
  s.options.noise = 0.0;
  s.options.quantisation = 1.0;
  s.run();
  for (const TrackObservation& o : s.result.observations) {
    REQUIRE(o.pixel == Vector2(o.pixel.array().round()));
    REQUIRE(o.noise.sigma() == Approx(std::sqrt(1.0 / 12.0)));
  }
  CHECK(rms(s, TrackKind::inlier) == Approx(std::sqrt(1.0 / 12.0)).epsilon(0.02));
}

TEST_CASE("Drop-outs leave gaps within tracks") {
  Sequence s;
  s.options.dropout_rate = 1.0;
  s.options.dropout_length = {0.1, 0.2};
  s.run();
  int gaps = 0;
  for (const auto& [id, track] : s.by_track()) {
    for (std::size_t i = 1; i < track.size(); ++i) gaps += track[i].t - track[i - 1].t > 0.1;
  }
  CHECK(gaps > 200);
}

TEST_CASE("A blackout has no observations and no track survives it") {
  Sequence s;
  s.options.blackouts = {5.0, 6.0};
  s.run();
  for (const auto& [id, track] : s.by_track()) REQUIRE((track.back().t < 5.0 || track.front().t > 6.0));
}

TEST_CASE("No two tracks follow the same dot at the same time") {
  Sequence s;
  s.scene_options.points = 400;
  s.run();
  std::map<std::array<double, 3>, double> ends;
  for (const auto& [id, track] : s.by_track()) {
    const Vector3& p = s.result.tracks[std::size_t(id)].point;
    const auto [entry, is_new] = ends.try_emplace({p.x(), p.y(), p.z()}, track.back().t);
    if (!is_new) REQUIRE(track.front().t > entry->second);
    entry->second = track.back().t;
  }
}

TEST_CASE("Tracks with a slow error deviate as much as their sigma states, with the stated correlation time") {
  Sequence plain, wandering;
  for (Sequence* s : {&plain, &wandering}) {
    s->options.lifetime = {4.0, 4.0};
    s->options.noise = 0.3;
  }
  wandering.options.wander = 0.8;
  wandering.options.wander_time = 0.3;
  plain.run();
  wandering.run();
  REQUIRE(plain.result.observations.size() == wandering.result.observations.size());
  double square = 0.0, product = 0.0, expected = 0.0;
  int count = 0;
  for (std::size_t i = 0; i < plain.result.observations.size(); ++i) {
    CHECK(wandering.result.observations[i].noise.sigma() == Approx(std::hypot(0.3, 0.8)));
    square += (wandering.result.observations[i].pixel - plain.result.observations[i].pixel).squaredNorm();
    count += 2;
  }
  const auto before = plain.by_track();
  for (const auto& [id, track] : wandering.by_track()) {
    const auto& other = before.at(id);
    for (std::size_t i = 0, j = 0; i < track.size(); ++i) {
      while (j < track.size() && track[j].t < track[i].t + 0.2) ++j;
      if (j == track.size()) break;
      product += (track[i].pixel - other[i].pixel).dot(track[j].pixel - other[j].pixel);
      expected += 2.0 * std::exp((track[i].t - track[j].t) / 0.3);
    }
  }
  CHECK(std::sqrt(square / count) == Approx(0.8).epsilon(0.05));
  CHECK(product / expected == Approx(0.64).epsilon(0.1));
  wandering.options.quantisation = 0.5;
  wandering.run();
  for (const TrackObservation& z : wandering.result.observations) {
    CHECK((2.0 * z.pixel - (2.0 * z.pixel).array().round().matrix()).norm() < 1e-9);
  }
}
