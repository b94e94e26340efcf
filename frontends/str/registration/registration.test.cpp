#include "frontends/str/registration/registration.hpp"

#include "core/geometry/so3.hpp"
#include "core/simulation/random.hpp"
#include "core/testing/catch2.hpp"
#include "core/testing/event_scene.hpp"
#include "frontends/str/registration/testing/rotation_recording.hpp"

using namespace evbench;
using namespace evbench::str;
using evbench::str::testing::RotationRecording;
using evbench::str::testing::simulate_rotation;
using evbench::testing::EventScene;

namespace {

const Vector3 kAxis = Vector3(0.5, 0.8, 0.33).normalized();

/// The batch of a recording's events in [from, to) [s].
Batch batch_of(std::span<const Event> events, double from, double to) {
  const auto a = std::llround(1e6 * from), b = std::llround(1e6 * to);
  const auto first = std::ranges::lower_bound(events, a, {}, &Event::t);
  const auto last = std::ranges::lower_bound(events, b, {}, &Event::t);
  return {{first, last}, a, b};
}

double relative_error(const Registration& registration, const Vector3& omega) {
  return (Vector3(project_onto(MotionModel::rotation, registration.A)) - omega).norm() / omega.norm();
}

/// Median relative error of all batches that move by `pixels`; every one must be registered.
double median_error(const RotationRecording& recording, double pixels, bool from_nothing) {
  Registrar registrar(recording.camera, {});
  const double duration = pixels / (recording.camera.pinhole.fx * recording.omega.norm());
  const double end = 1e-6 * static_cast<double>(recording.events.back().t);
  std::vector<double> errors;
  std::optional<Matrix3> last;
  for (double t = 0.0; t + duration <= end; t += duration) {
    const Registration found =
        registrar.align(batch_of(recording.events, t, t + duration), from_nothing ? std::nullopt : last);
    REQUIRE(found.good());
    last = found.A;
    errors.push_back(relative_error(found, recording.omega));
  }
  std::ranges::nth_element(errors, errors.begin() + static_cast<std::ptrdiff_t>(errors.size() / 2));
  return errors[errors.size() / 2];
}

}  // namespace

TEST_CASE("The rotation of a camera is found from slow to aggressive, with and without a start", "[long]") {
  const double speed = GENERATE(1.0, 5.0, 20.0);
  const std::string scene = GENERATE("shapes", "plane");
  const RotationRecording recording = simulate_rotation(scene, 240, 180, speed * kAxis, 0.33 / speed, 1);
  for (const bool from_nothing : {false, true}) {
    CHECK(median_error(recording, 5.0, from_nothing) < 0.02);
    CHECK(median_error(recording, 10.0, from_nothing) < 0.01);
    CHECK(median_error(recording, 30.0, from_nothing) < 0.01);
  }
}

TEST_CASE("An approaching and rotating plane is a motion of four parameters, found with four and with eight") {
  constexpr double kDuration = 0.1;
  const Vector6 twist = (Vector6() << 0.0, 0.0, 1.0, 0.6, -0.4, 0.5).finished();
  const EventScene scene([&](double t) { return se3::exp((t - 0.5 * kDuration) * twist); }, kDuration,
                         EventScene::quadrangles(150, 1));
  // Rays r = (x, y, 1) of the plane z = Z: at the reference time r + t (ω × r + v / Z), and the depth goes like the
  // rest.
  const Vector3 omega = twist.head<3>(), v = twist.tail<3>() / EventScene::kDistance;
  Matrix3 truth = so3::hat(omega);
  truth.col(2) += v;
  for (const MotionModel model : {MotionModel::planar_4, MotionModel::planar_8}) {
    RegistrationOptions options;
    options.model = model;
    options.queries = 0;
    Registrar registrar(scene.camera(), options);
    const Registration found = registrar.align(batch_of(scene.list, 0.0, kDuration), std::nullopt);
    REQUIRE(found.good());
    const MotionParameters expected = project_onto(model, truth), theta = project_onto(model, found.A);
    for (const Vector2& corner : {Vector2(0.5, 0.4), Vector2(-0.5, 0.4), Vector2(0.0, 0.0)}) {
      const auto x = static_cast<float>(corner.x()), y = static_cast<float>(corner.y());
      const Eigen::Vector2f error = flow((found.A - truth).cast<float>(), x, y);
      CHECK(200.0 * kDuration * static_cast<double>(error.norm()) < 0.5);  // [px]
    }
    CHECK((theta - expected).norm() < 0.15 * expected.norm());
  }
}

TEST_CASE("Batches with too few events have no motion, and report it") {
  const EventScene scene(
      [](double t) {
        return SE3{so3::exp(t * kAxis), Vector3::Zero()};
      },
      0.2, EventScene::quadrangles(150, 1));
  Registrar registrar(scene.camera(), {});
  const auto few = [](std::size_t count) {
    std::vector<Event> events(count);
    for (std::size_t i = 0; i < count; ++i) events[i] = {static_cast<std::int64_t>(10 * i), 50, 60, true};
    return events;
  };
  for (const std::size_t count : {std::size_t{0}, std::size_t{1}, std::size_t{5}}) {
    const std::vector<Event> events = few(count);
    for (const std::optional<Matrix3>& start : {std::optional<Matrix3>(), std::optional<Matrix3>(Matrix3::Zero())}) {
      const Registration found = registrar.align({events, 0, 10'000}, start);
      CHECK(found.state == Registration::State::too_few_events);
      CHECK(found.A.isZero());
    }
  }
  CHECK(to_string(Registration::State::too_few_events) == "too few events");
  // All at one time, and all at one pixel.
  const std::vector<Event> one_pixel = few(5000);
  CHECK(registrar.align({one_pixel, 0, 50'000}, std::nullopt).A.allFinite());
  std::vector<Event> one_time = few(5000);
  for (Event& event : one_time) event.t = 7;
  CHECK_FALSE(registrar.align({one_time, 0, 50'000}, std::nullopt).good());
  CHECK(registrar.align({one_time, 7, 7}, std::nullopt).A.allFinite());
}

TEST_CASE("A million random events in 10 ms give a finite motion within the iterations") {
  Random random(1);
  std::vector<Event> events(1'000'000);
  for (std::size_t i = 0; i < events.size(); ++i) {
    events[i] = {static_cast<std::int64_t>(i / 100), static_cast<std::uint16_t>(random.index(240)),
                 static_cast<std::uint16_t>(random.index(180)), random.index(2) == 1};
  }
  const EventScene nothing([](double) { return SE3(); }, 0.01, {});
  Registrar registrar(nothing.camera(), {});
  const Registration found = registrar.align({events, 0, 10'000}, std::nullopt);
  CHECK(found.A.allFinite());
  CHECK(found.alignment.iterations <= RegistrationOptions().alignment.iterations);
}

TEST_CASE("The motion is found though half of the pixels flicker") {
  RotationRecording recording = simulate_rotation("shapes", 240, 180, 2.0 * kAxis, 0.05, 1);
  Random random(2);
  std::vector<Event> flicker;
  for (std::uint16_t y = 0; y < 180; ++y) {
    for (std::uint16_t x = 0; x < 240; ++x) {
      if (random.index(2) == 0) continue;
      const auto t = static_cast<std::int64_t>(random.index(50'000));
      flicker.push_back({t, x, y, random.index(2) == 1});
    }
  }
  recording.events.insert(recording.events.end(), flicker.begin(), flicker.end());
  std::ranges::stable_sort(recording.events, {}, &Event::t);
  Registrar registrar(recording.camera, {});
  const Registration found = registrar.align(batch_of(recording.events, 0.0, 0.05), std::nullopt);
  CHECK(relative_error(found, recording.omega) < 0.03);
}

TEST_CASE("A stationary camera with noise is not estimated to move") {
  Random random(1);
  std::vector<Event> events;
  for (std::int64_t t = 0; t < 50'000; t += 20) {
    events.push_back({t, static_cast<std::uint16_t>(random.index(240)), static_cast<std::uint16_t>(random.index(180)),
                      random.index(2) == 1});
  }
  const EventScene nothing([](double) { return SE3(); }, 0.01, {});
  Registrar registrar(nothing.camera(), {});
  CHECK_FALSE(registrar.align({events, 0, 50'000}, std::nullopt).good());
}

TEST_CASE("A motion that reverses within a batch is not accepted, or is small") {
  constexpr double kDuration = 0.1;
  const EventScene scene(
      [](double t) {
        return SE3{so3::exp((0.05 - std::abs(t - 0.05)) * 4.0 * kAxis), Vector3::Zero()};
      },
      kDuration, EventScene::quadrangles(150, 1));
  Registrar registrar(scene.camera(), {});
  const Registration found = registrar.align(batch_of(scene.list, 0.0, kDuration), Matrix3(so3::hat(4.0 * kAxis)));
  // The camera is where it began; half-way it had moved by 40 px.
  INFO("fit " << found.alignment.fit << ", motion " << found.motion << " px, " << to_string(found.state));
  CHECK((!found.good() || found.motion < 4.0));
}
