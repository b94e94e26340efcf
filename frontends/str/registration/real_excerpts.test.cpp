// Against contrast maximisation, on real events.
#include <fmt/format.h>

#include "core/data/calib.hpp"
#include "core/events/event_stream.hpp"
#include "core/testing/catch2.hpp"
#include "core/testing/data.hpp"
#include "frontends/str/registration/registration.hpp"
#include "frontends/str/registration/testing/contrast.hpp"

using namespace evbench;
using namespace evbench::str;

namespace {

struct Excerpt {
  Camera camera;
  std::vector<Event> events;
};

std::optional<Excerpt> read_excerpt(const std::string& name) {
  const auto calib = evbench::testing::data_file(name + "/calib.txt");
  const auto path = evbench::testing::data_file(name + "/events_excerpt.txt");
  if (!calib || !path) return std::nullopt;
  Excerpt result{read_calib(*calib, 240, 180), {}};
  StreamOptions options;
  options.read.width = 240;
  options.read.height = 180;
  EventStream stream(*path, options);
  for (std::vector<Event> chunk; stream.read(chunk);) {
    result.events.insert(result.events.end(), chunk.begin(), chunk.end());
  }
  return result;
}

/// Registered without a start, then by contrast from there: the relative difference of the angular velocities.
double difference(const Excerpt& excerpt, std::int64_t from, std::int64_t to) {
  const auto first = std::ranges::lower_bound(excerpt.events, from, {}, &Event::t);
  const auto last = std::ranges::lower_bound(excerpt.events, to, {}, &Event::t);
  const Batch batch{{first, last}, from, to};
  Registrar registrar(excerpt.camera, {});
  const Registration found = registrar.align(batch, std::nullopt);
  REQUIRE(found.good());
  EventCloud cloud;
  make_cloud(batch.events, registrar.rays(), (from + to) / 2, cloud);
  const MotionParameters theta = project_onto(MotionModel::rotation, found.A);
  const MotionParameters sharpest = str::testing::maximise_contrast(
      cloud, MotionModel::rotation, theta, 0.1 * theta.norm(), registrar.rays().focal_length());
  const double error = (theta - sharpest).norm() / sharpest.norm();
  UNSCOPED_INFO(
      fmt::format("{} events, {:.1f} px: registered ({:.4f}, {:.4f}, {:.4f}) rad/s, fit {:.2f}; by contrast "
                  "({:.4f}, {:.4f}, {:.4f}); {:.1f} %",
                  batch.events.size(), found.motion, theta[0], theta[1], theta[2], found.alignment.fit, sharpest[0],
                  sharpest[1], sharpest[2], 100.0 * error));
  return error;
}

}  // namespace

TEST_CASE("Registration of real rotations agrees with contrast maximisation: within 5 %, parts of 4 px within 10 %",
          "[slow]") {
  // Parts in which the camera moves 4 px or more: 12 and 8 px in all.
  const auto [name, parts] = GENERATE(std::pair("shapes_rotation", 2), std::pair("dynamic_rotation", 2));
  const auto excerpt = read_excerpt(name);
  if (!excerpt) return;
  const std::int64_t from = excerpt->events.front().t, to = excerpt->events.back().t + 1;
  CHECK(difference(*excerpt, from, to) < 0.05);
  for (int part = 0; part < parts; ++part) {
    CHECK(difference(*excerpt, from + part * (to - from) / parts, from + (part + 1) * (to - from) / parts) < 0.1);
  }
}
