#include "core/sources/event_simulation.hpp"

#include <fmt/format.h>
#include <tbb/global_control.h>

#include <filesystem>
#include <opencv2/imgcodecs.hpp>

#include "core/plugin/registration.hpp"
#include "core/support/json.hpp"
#include "core/testing/catch2.hpp"
#include "core/testing/data.hpp"

using namespace evbench;
using Catch::Matchers::ContainsSubstring;

namespace {

EventSimulation simulation(const std::string& json, std::uint64_t seed = 1, const std::string& folder = "") {
  return {read_options<EventSimulation::Options>(parse_json(json), "config"), {seed, folder}};
}

std::vector<Event> events_of(const Source& source) {
  std::vector<Event> all;
  const std::unique_ptr<EventStream> reader = source.events();
  for (std::vector<Event> chunk; reader->read(chunk);) all.insert(all.end(), chunk.begin(), chunk.end());
  return all;
}

const std::string kSmall = R"("duration": 0.1, "camera": {"width": 96, "height": 72, "focal_length": 80})";

}  // namespace

TEST_CASE("A simulated recording is registered, and gives events, its camera, ground truth and tracks") {
  const Plugins plugins = registered_plugins();
  const auto& entry = plugins.of<Source>().find("event_simulation", "test");
  const auto source = entry.make(parse_json("{" + kSmall + "}"), {7, "", "config.source"});
  CHECK(source->camera().width == 96);
  CHECK(source->ground_truth().size() == 21);
  CHECK(source->true_tracks()->size() > 100);
  const auto reader = source->events();
  CHECK(reader->info().width == 96);
  const auto events = events_of(*source);
  CHECK(events.size() > 2000);
  CHECK(events.back().t <= 100000);
}

TEST_CASE("A source of tracks has no events") {
  const Plugins plugins = registered_plugins();
  const auto& entry = plugins.of<Source>().find("simulation", "test");
  CHECK(entry.make(parse_json(R"({"duration": 1})"), {7, "", "config.source"})->events() == nullptr);
}

TEST_CASE("Every scene gives the same events with any number of threads, and others with another seed") {
  const tbb::global_control four(tbb::global_control::max_allowed_parallelism, 4);
  const std::string scene = GENERATE("plane", "dots", "shapes", "boxes");
  const auto events = [&](int threads, std::uint64_t seed) {
    return events_of(simulation(
        fmt::format(R"({{{}, "scene": {{"kind": "{}"}}, "simulator": {{"threads": {}}}}})", kSmall, scene, threads),
        seed));
  };
  const auto one = events(1, 1);
  CHECK(one.size() > 500);
  CHECK(events(2, 1) == one);
  CHECK(events(4, 1) == one);
  CHECK(events(1, 2) != one);
}

TEST_CASE("The true track of a point, its depth and the point seen at a pixel agree, and boxes hide points", "[slow]") {
  const auto source = simulation(R"({"duration": 1, "scene": {"kind": "boxes"},
      "camera": {"distortion": "radial_tangential", "coefficients": [-0.35, 0.15, 0, 0, 0]}})");
  const SceneTruth truth = source.truth();
  int seen = 0, hidden = 0;
  for (const Vector3& point : source.scene().features) {
    for (const double t : {0.1, 0.8}) {
      const SE3 T = truth.pose(t);
      const auto pixel = truth.pixel(point, t);
      if (!pixel) {
        hidden += visible_pixel(source.camera(), T, point, 0.0).has_value() ? 1 : 0;
        continue;
      }
      ++seen;
      REQUIRE(*truth.depth(*pixel, t) == Approx((T.inverse() * point).z()).epsilon(1e-3));
      REQUIRE((*truth.point(*pixel, t) - point).norm() < 1e-2);
    }
  }
  CHECK(seen > 100);
  CHECK(hidden > 100);
}

TEST_CASE("Events come where the true track of a dot's rim passes") {
  const auto source = simulation(R"({"duration": 0.3, "scene": {"kind": "dots"}, "simulator": {"sensor":
      {"noise_rate": 0, "leak_rate": 0}}})");
  const SceneTruth truth = source.truth();
  const auto events = events_of(source);
  REQUIRE(events.size() > 1000);
  int near = 0, tried = 0;
  for (std::size_t i = 0; i < events.size(); i += 50) {
    const double t = 1e-6 * static_cast<double>(events[i].t);
    double distance = 1e9;
    for (const Vector3& point : source.scene().features) {
      const Vector2 pixel = source.camera().project(truth.pose(t).inverse() * point);
      distance = std::min(distance, (pixel - Vector2(events[i].x, events[i].y)).norm());
    }
    ++tried;
    near += std::abs(distance - 3.5) < 1.8 ? 1 : 0;  // dots are 7 px wide at mean depth
  }
  CHECK(near > 0.95 * tried);
}

TEST_CASE("A picture and a calibration can be read, and their faults are named") {
  const testing::TemporaryFolder folder;
  cv::Mat picture(60, 80, CV_8U);
  cv::randu(picture, 0, 255);
  cv::imwrite(folder.file("picture.png"), picture);
  folder.write("calib.txt", "80 80 47.5 35.5 -0.3 0.1 0 0 0");
  const auto source = simulation(R"({"duration": 0.1, "scene": {"picture": "picture.png"},
      "camera": {"width": 96, "height": 72, "calib": "calib.txt", "distortion": "radial_tangential"}})",
                                 1, folder.path());
  CHECK(source.files() == std::vector<std::string>{folder.file("calib.txt"), folder.file("picture.png")});
  CHECK(source.camera().coefficients[0] == -0.3);
  CHECK(events_of(source).size() > 1000);
  CHECK_THROWS_WITH(simulation(R"({"duration": 0.1, "scene": {"picture": "calib.txt"}})", 1, folder.path()),
                    ContainsSubstring("can't be read as a picture"));
  CHECK_THROWS_WITH(simulation(R"({"duration": 0.1, "scene": {"picture": "none.png"}})", 1, folder.path()),
                    ContainsSubstring("none.png: no such file"));
  CHECK_THROWS_WITH(simulation(R"({"duration": 0.1, "scene": {"near": 3, "far": 2}})"),
                    ContainsSubstring("near < far"));
  CHECK_THROWS_WITH(simulation(R"({"duration": 0.1, "simulator": {"sensor": {"threshold_on": 0}}})"),
                    ContainsSubstring("threshold_on"));
  CHECK_THROWS_WITH(simulation(R"({"duration": 0.1, "simulator": {"sensor": {"refractory": -1}}})"),
                    ContainsSubstring("refractory"));
  CHECK_THROWS_WITH(simulation(R"({"duration": 0.1, "camera": {"width": 10000, "height": 10000}})"),
                    ContainsSubstring("10000 x 10000 pixels; expected at most"));
}

TEST_CASE("A motion that leads through the plane is refused, with the time at which it does") {
  CHECK_THROWS_WITH(simulation(R"({"duration": 3, "motion": {"kind": "smooth_random", "amplitude": 3},
                                   "scene": {"near": 0.2, "far": 0.4}})"),
                    ContainsSubstring("s the camera is") && ContainsSubstring("before the plane"));
}

TEST_CASE("Simulated events are kept in a folder, in a file for each simulation, and read from there") {
  const testing::TemporaryFolder folder;
  const auto with_cache = "{" + kSmall + R"(, "cache": "kept"})";
  const auto files = [&] {
    return std::distance(std::filesystem::directory_iterator(folder.file("kept")),
                         std::filesystem::directory_iterator());
  };
  const auto expected = events_of(simulation("{" + kSmall + "}"));
  CHECK(events_of(simulation(with_cache, 1, folder.path())) == expected);
  CHECK(files() == 1);
  CHECK(events_of(simulation(with_cache, 1, folder.path())) == expected);
  CHECK(files() == 1);
  CHECK(events_of(simulation(with_cache, 2, folder.path())) != expected);
  const auto other = "{" + kSmall + R"(, "cache": "kept", "scene": {"texture": "stripes"}})";
  CHECK(events_of(simulation(other, 1, folder.path())) != expected);
  CHECK(files() == 3);
}

TEST_CASE("Every texture and light gives events, and other ones") {
  std::vector<std::vector<Event>> all;
  for (const std::string options :
       {R"("scene": {"texture": "leaves"})", R"("scene": {"texture": "stripes"})", R"("scene": {"texture": "bare"})",
        R"("scene": {"texture": "repeated"})", R"("scene": {"light": 5})", R"("rendering": {"vignetting": 0.7})",
        R"("simulator": {"sensor": {"bandwidth": 200}})"}) {
    INFO(options);
    all.push_back(events_of(simulation("{" + kSmall + ", " + options + "}")));
    CHECK(all.back().size() > 300);
    CHECK(std::ranges::count(all, all.back()) == 1);
  }
}
