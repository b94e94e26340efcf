#include "core/structure/multi_view.hpp"

#include <cmath>

#include "core/structure/depth_reversal.hpp"
#include "core/structure/resection.hpp"
#include "core/support/median.hpp"
#include "core/testing/catch2.hpp"
#include "core/testing/point_scene.hpp"

namespace evbench {
namespace {

using testing::davis;
using testing::PointScene;

constexpr double kWidth = 3.0;  ///< [px]
constexpr int kIterations = 20;

SE3 moving(double t) { return {so3::exp(Vector3(0.05 * t, -0.1 * t, 0.1 * t)), Vector3(0.5 * t, 0.1 * t, 0.1 * t)}; }

/// 50 tracks over a second, and the two-view guess of its first and last view.
struct Sequence {
  TrackBuffer tracks;
  InitialGuess guess;  ///< the truth

  explicit Sequence(double noise, int outliers = 0) {
    Random random(3);
    guess.t1 = 1.0;
    guess.T1 = moving(1.0);
    TrackId id = 0;
    for (const Vector3& point : testing::scene_points(PointScene::volume, 50, random)) {
      for (double t = 0.0; t <= 1.0; t += 0.01) {
        Vector2 pixel = davis().project(moving(t).inverse() * point) + testing::noise(noise, random);
        if (id < outliers) pixel += 40.0 * t * Vector2(std::cos(id), std::sin(id));
        const UndistortedObservation z{id, t, pixel, std::max(noise, 0.01)};
        tracks.add({&z, 1});
      }
      guess.landmarks.push_back({id, point});
      ++id;
    }
  }

  TrackViews views() const { return TrackViews::of(tracks, {0.0, 0.25, 0.5, 0.75, 1.0}, 0.1, 60); }
};

double angle(const Vector3& a, const Vector3& b) { return std::atan2(a.cross(b).norm(), a.dot(b)); }

}  // namespace

TEST_CASE("Motion and points are recovered from several views despite outlier tracks") {
  const Sequence sequence(0.5, 8);
  const MultiView views(sequence.views(), davis());
  InitialGuess rough = sequence.guess;
  rough.T1.p += Vector3(0.05, -0.05, 0.03);
  for (Landmark& landmark : rough.landmarks) landmark.position *= 1.0 + 0.2 * std::sin(landmark.track);
  auto estimate = views.start(rough, kWidth);
  REQUIRE(estimate);
  views.refine(*estimate, kWidth, kIterations);
  views.refine(*estimate, 1.0, kIterations);  // a loss as narrow as the noise
  CHECK(angle(estimate->poses.back().p, moving(1.0).p) < 0.05);
  CHECK(estimate->poses.back().q.angularDistance(moving(1.0).q) < 0.01);
  const std::vector<double> errors = views.errors(*estimate);
  CHECK(*std::max_element(errors.begin() + 8, errors.end()) < 1.0);
  const double unit = estimate->points[20].position().norm() / sequence.guess.landmarks[20].position.norm();
  for (std::size_t i = 8; i < estimate->points.size(); ++i) {
    CHECK((estimate->points[i].position() / unit - sequence.guess.landmarks[i].position).norm() < 0.4);
  }
}

TEST_CASE("The depth-reversed scene costs clearly more once the motion is long") {
  const Sequence sequence(0.5, 4);
  const MultiView views(sequence.views(), davis());
  auto truth = views.start(sequence.guess, kWidth);
  InitialGuess unit = sequence.guess;
  for (Landmark& landmark : unit.landmarks) landmark.position /= 2.3;
  unit.T1.p /= 2.3;
  auto reversed = views.start(reverse_depth(unit), kWidth);
  REQUIRE(truth);
  REQUIRE(reversed);
  views.refine(*truth, kWidth, kIterations);
  views.refine(*reversed, kWidth, kIterations);
  CHECK(reversed->cost > 1.2 * truth->cost);
}

TEST_CASE("The uncertainty of the structure follows from the noise") {
  std::vector<double> sigmas;
  for (const double noise : {0.3, 0.6}) {
    const Sequence sequence(noise);
    const MultiView views(sequence.views(), davis());
    auto estimate = views.start(sequence.guess, kWidth);
    REQUIRE(estimate);
    views.refine(*estimate, kWidth, kIterations);
    sigmas.push_back(median(views.distance_sigmas(*estimate)));
  }
  CHECK(sigmas[0] > 0.0);
  CHECK(sigmas[1] == Approx(2.0 * sigmas[0]).epsilon(0.3));
}

TEST_CASE("At most the requested number of tracks is used, those with most views first") {
  Sequence sequence(0.0);
  for (const double t : {0.0, 0.25, 0.5}) {
    const UndistortedObservation z{99, t, {100.0, 100.0}, 1.0};
    sequence.tracks.add({&z, 1});
  }
  const TrackViews all = TrackViews::of(sequence.tracks, {0.0, 0.25, 0.5, 1.0}, 0.1, 100);
  CHECK(all.tracks.size() == 51);
  CHECK(all.tracks.back() == 99);
  CHECK(TrackViews::of(sequence.tracks, {0.0, 0.25, 0.5, 1.0}, 0.1, 20).tracks.size() == 20);
}

TEST_CASE("Resection finds the camera although a quarter of the observations is wrong") {
  Random random(5);
  std::vector<InversePoint> points;
  std::vector<Vector2> pixels;
  for (const Vector3& point : testing::scene_points(PointScene::volume, 40, random)) {
    pixels.push_back(davis().project(moving(0.6).inverse() * point));
    if (points.size() % 4 == 0) pixels.back() += Vector2(25.0, -10.0);
    points.push_back({point.normalized(), 1.0 / point.norm()});
  }
  const auto found = resect(moving(0.3), points, pixels, davis(), 1.5);
  REQUIRE(found);
  CHECK((found->T.p - moving(0.6).p).norm() < 5e-3);
  CHECK(found->median_px < 0.2);
  CHECK_FALSE(resect(moving(0.3), std::span(points).first(3), std::span(pixels).first(3), davis(), 1.5));
}

}  // namespace evbench
