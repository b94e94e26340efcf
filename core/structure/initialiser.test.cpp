#include "core/structure/initialiser.hpp"

#include <cmath>

#include "core/data/calib.hpp"
#include "core/data/tracks.hpp"
#include "core/data/tum.hpp"
#include "core/plugin/undistort.hpp"
#include "core/testing/catch2.hpp"
#include "core/testing/data.hpp"
#include "core/testing/point_scene.hpp"

using namespace evbench;
using evbench::testing::davis;
using evbench::testing::PointScene;

namespace {

/// Observations at 200 Hz with a random phase per track, for 0 ≤ t ≤ duration, in time order.
template <class Motion>
TrackBuffer tracks_of(PointScene scene, const Motion& motion, double duration, double noise, std::uint64_t seed) {
  Random random(seed);
  TrackBuffer buffer;
  TrackId id = 0;
  for (const Vector3& point : testing::scene_points(scene, 50, random)) {
    std::vector<UndistortedObservation> track;
    for (double t = random.uniform(0.0, 0.005); t <= duration; t += 0.005) {
      const Vector3 local = motion(t).inverse() * point;
      track.push_back({id, t, davis().project(local) + testing::noise(noise, random), 1.0});
    }
    buffer.add(track);
    ++id;
  }
  return buffer;
}

SE3 moving(double t) {
  return se3::exp((Vector6() << 0.1 * t, -0.2 * t, 0.1 * t, 0.5 * t, 0.1 * t, 0.1 * t).finished());
}
SE3 rotating(double t) { return se3::exp((Vector6() << 0.1 * t, -0.2 * t, 0.1 * t, 0, 0, 0).finished()); }
SE3 resting(double) { return {}; }

double angle_deg(const Vector3& a, const Vector3& b) { return std::atan2(a.cross(b).norm(), a.dot(b)) * kDegrees; }

}  // namespace

TEST_CASE("a moving camera is initialised once the parallax suffices, with the right motion") {
  for (const PointScene scene : {PointScene::volume, PointScene::plane}) {
    const TrackBuffer tracks = tracks_of(scene, moving, 1.0, 0.5, 3);
    Initialiser initialiser({}, davis());
    double found = 0.0;
    for (double t = 0.03; t < 1.0 && found == 0.0; t += 0.05) {
      const Initialiser::Attempt attempt = initialiser.attempt(tracks, t);
      CHECK(attempt.candidates.empty() == !attempt.reason.empty());
      if (attempt.candidates.empty()) continue;
      found = t;
      const SE3 truth = moving(*initialiser.reference_time()).inverse() * moving(t);
      double best = 180.0;
      for (const InitialGuess& guess : attempt.candidates) {
        best = std::min(best, angle_deg(guess.T1.p, truth.p));
        CHECK(guess.t1 == t);
        CHECK(guess.t0 == *initialiser.reference_time());
        std::vector<double> depths;
        for (const Landmark& landmark : guess.landmarks) depths.push_back(landmark.position.z());
        std::sort(depths.begin(), depths.end());
        CHECK(depths[depths.size() / 2] == Approx(1.0));
      }
      CHECK(best < 12.0);
    }
    CHECK(found > 0.1);
    CHECK(found < 0.6);
  }
}

TEST_CASE("a camera at rest or in pure rotation is never initialised") {
  for (const auto motion : {rotating, resting}) {
    const TrackBuffer tracks = tracks_of(PointScene::volume, motion, 2.0, 0.7, 5);
    Initialiser initialiser({}, davis());
    for (double t = 0.03; t < 2.0; t += 0.1) {
      const Initialiser::Attempt attempt = initialiser.attempt(tracks, t);
      CHECK(attempt.candidates.empty());
      CHECK_FALSE(attempt.reason.empty());
    }
  }
}

TEST_CASE("the first view moves on when its tracks have ended") {
  TrackBuffer tracks = tracks_of(PointScene::volume, moving, 0.1, 0.0, 7);
  std::vector<UndistortedObservation> later;
  for (TrackId id : tracks.ids()) {
    for (UndistortedObservation z : tracks.observations(id)) later.push_back({id + 100, z.t + 0.5, z.pixel, z.noise});
  }
  tracks.add(later);
  Initialiser initialiser({}, davis());
  initialiser.attempt(tracks, 0.02);
  CHECK(initialiser.reference_time() == 0.02);
  CHECK(
      initialiser.attempt(tracks, 0.3).reason ==
      "0 tracks common to the views at 0.020 s and 0.300 s, 15 needed; 0 tracks observed around 0.300 s, 15 needed for "
      "a first view");
  CHECK_FALSE(initialiser.reference_time());
  initialiser.attempt(tracks, 0.55);
  CHECK(initialiser.reference_time() == 0.55);
}

TEST_CASE("tracks in view and tracks common to both views are counted separately in the reason") {
  TrackBuffer tracks;
  const auto see = [&](TrackId id, double from, double to) {
    for (double t = from; t < to; t += 0.01) tracks.add(std::vector{UndistortedObservation{id, t, {50.0, 50.0}, 1.0}});
  };
  for (TrackId id = 0; id < 20; ++id) see(id, 0.0, id == 0 ? 1.0 : 0.5);
  for (TrackId id = 20; id < 40; ++id) see(id, 0.6, 1.0);
  Initialiser initialiser({}, davis());
  initialiser.attempt(tracks, 0.1);
  CHECK(initialiser.attempt(tracks, 0.8).reason ==
        "1 track common to the views at 0.100 s and 0.800 s, 15 needed; first view set at 0.800 s with 21 tracks");
}

TEST_CASE("no tracks give no guess") {
  Initialiser initialiser({}, davis());
  CHECK(initialiser.attempt({}, 1.0).candidates.empty());
}

TEST_CASE("the real tracks of poster_translation start with the true direction of motion") {
  const auto tracks_file = testing::data_file("poster_translation/tracks_eklt.txt");
  if (!tracks_file) return;
  const Camera camera = read_calib(*testing::data_file("poster_translation/calib.txt"), 240, 180);
  const PoseTrajectory truth = read_tum(*testing::data_file("poster_translation/groundtruth.txt"));
  TrackBuffer tracks;
  for (const TrackObservation& raw : read_tracks(*tracks_file, 240, 180).observations) {
    const UndistortedObservation z = undistort(raw, camera).value();
    tracks.add(std::span(&z, 1));
  }
  Initialiser initialiser({}, camera.pinhole);
  bool found = false;
  for (double t = 0.08; t < 1.0; t += 0.05) {
    const Initialiser::Attempt attempt = initialiser.attempt(tracks, t);
    if (attempt.candidates.empty()) {
      UNSCOPED_INFO(t << ": " << attempt.reason);
      continue;
    }
    const SE3 motion = truth.pose(*initialiser.reference_time())->inverse() * *truth.pose(t);
    double best = 180.0;
    for (const InitialGuess& guess : attempt.candidates) {
      best = std::min(best, angle_deg(guess.T1.p, motion.p));
      UNSCOPED_INFO(t << ": " << guess.landmarks.size() << " landmarks, parallax " << guess.median_parallax_deg
                      << ", direction error " << angle_deg(guess.T1.p, motion.p) << " rotation error "
                      << guess.T1.q.angularDistance(motion.q) * kDegrees);
    }
    found = true;
    CHECK(best < 20.0);
  }
  CHECK(found);
}
