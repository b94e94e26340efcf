#include "backends/rotation_averaging/rotation_averaging.hpp"

#include "core/geometry/so3.hpp"
#include "core/simulation/random.hpp"
#include "core/testing/catch2.hpp"

using namespace evbench;

namespace {

Vector3 random_vector(Random& random, double size) {
  return size * random.uniform3({-1.0, -1.0, -1.0}, {1.0, 1.0, 1.0});
}

Eigen::Quaterniond turning(double t) { return so3::exp({0.4 * std::sin(1.3 * t), 0.6 * std::sin(t), 0.5 * t}); }

const PinholeCamera kCamera{200.0, 200.0, 119.5, 89.5};

/// Far points seen by a rotating camera, each at its own times; `wrong` of every ten drift.
std::vector<UndistortedObservation> observations(double duration, double noise, int wrong) {
  Random random(1);
  std::vector<UndistortedObservation> result;
  for (TrackId track = 0; track < 400; ++track) {
    const Vector3 point = random_vector(random, 1.0).normalized();
    const Vector2 off = track % 10 < wrong ? random.uniform2({-20, -20}, {20, 20}) : Vector2(0, 0);
    for (double t = random.uniform(0.0, 0.02); t < duration; t += 0.02) {
      const Vector3 seen = turning(t).conjugate() * point;
      if (seen.z() < 0.5) continue;
      const Vector2 pixel = kCamera.project(seen);
      if (pixel.x() < 0 || pixel.y() < 0 || pixel.x() > 239 || pixel.y() > 179) continue;
      result.push_back({track, t, pixel + t * off + random.normal2() * noise, 0.5});
    }
  }
  std::ranges::stable_sort(result, {}, &UndistortedObservation::t);
  return result;
}

RotationAveraging run(const std::vector<UndistortedObservation>& all, double duration) {
  BackEndContext context;
  context.camera = kCamera;
  RotationAveraging backend({}, context);
  std::size_t next = 0;
  for (double t = 0.05; t < duration + 0.01; t += 0.05) {
    UndistortedBatch batch;
    batch.until = t;
    for (; next < all.size() && all[next].t <= t; ++next) batch.observations.push_back(all[next]);
    backend.advance(batch);
  }
  backend.finish();
  return backend;
}

/// [rad] of the rotation between the first and the last pose.
double final_error(const PoseTrajectory& trajectory) {
  const StampedPose &first = trajectory.poses().front(), &last = trajectory.poses().back();
  const Eigen::Quaterniond truth = turning(first.t).conjugate() * turning(last.t);
  return so3::log((truth.conjugate() * first.T.q.conjugate() * last.T.q).normalized()).norm();
}

}  // namespace

TEST_CASE("Directions are aligned although some are wrong") {
  Random random(3);
  const Eigen::Quaterniond R = so3::exp({0.3, -0.2, 0.5});
  std::vector<std::pair<Vector3, Vector3>> pairs;
  for (int i = 0; i < 40; ++i) {
    const Vector3 right = random_vector(random, 1.0).normalized();
    pairs.emplace_back(i % 5 == 0 ? random_vector(random, 1.0).normalized() : Vector3(R * right), right);
  }
  const auto found = align_directions(pairs, 0.01);
  REQUIRE(found);
  CHECK(found->R.angularDistance(R) < 1e-3);
  CHECK_FALSE(align_directions(std::span(pairs).first(1), 0.01));
}

TEST_CASE("Averaged rotations are more accurate than chained ones, and a wrong edge does no harm") {
  constexpr std::size_t kRotations = 200;
  Random random(1);
  std::vector<Eigen::Quaterniond> truth, chained(kRotations, Eigen::Quaterniond::Identity());
  for (std::size_t i = 0; i < kRotations; ++i) truth.push_back(turning(0.02 * static_cast<double>(i)));
  std::vector<RotationEdge> edges;
  for (const std::size_t span : {1, 4, 16, 64}) {
    for (std::size_t i = 0; i + span < kRotations; ++i) {
      const Eigen::Quaterniond R = truth[i].conjugate() * truth[i + span] * so3::exp(random_vector(random, 0.003));
      edges.push_back({i, i + span, i == 100 && span == 16 ? so3::exp({1.0, 0.0, 0.0}) : R, 1e5});
      if (span == 1) chained[i + 1] = chained[i] * R;
    }
  }
  std::vector<Eigen::Quaterniond> averaged = chained;
  average_rotations(edges, 0.01, averaged);
  const auto error = [&](const std::vector<Eigen::Quaterniond>& rotations) {
    double sum = 0.0;
    for (std::size_t i = 0; i < kRotations; ++i) {
      sum += (truth[0].conjugate() * truth[i]).angularDistance(rotations[0].conjugate() * rotations[i]);
    }
    return sum / kRotations;
  };
  CHECK(error(averaged) < 0.5 * error(chained));
  CHECK(error(averaged) < 0.005);
}

TEST_CASE("A rotating camera is followed with exact tracks, and with noise and outliers") {
  const RotationAveraging exact = run(observations(4.0, 0.0, 0), 4.0);
  CHECK(exact.status().state == RunState::ok);
  CHECK(final_error(exact.trajectory()) < 1e-3);
  const RotationAveraging noisy = run(observations(4.0, 0.5, 2), 4.0);
  CHECK(noisy.status().state == RunState::ok);
  CHECK(final_error(noisy.trajectory()) < 0.02);
  for (const StampedPose& pose : noisy.trajectory().poses()) CHECK(pose.T.p.isZero());
}

TEST_CASE("Without tracks there is no rotation, and when they end tracking is lost") {
  CHECK(run({}, 1.0).status().state == RunState::failed);
  std::vector<UndistortedObservation> early = observations(4.0, 0.0, 0);
  std::erase_if(early, [](const UndistortedObservation& z) { return z.t > 1.0; });
  const RotationAveraging lost = run(early, 4.0);
  CHECK(lost.status().state == RunState::lost);
  CHECK(lost.trajectory().end() > 0.9);
}
