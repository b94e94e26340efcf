// event_reality: simulated events beside real ones. EVBENCH_DATA names the folder of real excerpts; the table goes to
// standard output as Markdown. Simulated is a similar scene along the same motion, with the same camera.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <map>

#include "core/data/calib.hpp"
#include "core/events/event_stream.hpp"
#include "core/geometry/so3.hpp"
#include "core/simulation/events/event_simulator.hpp"
#include "core/simulation/events/scene_brightness.hpp"
#include "core/support/error.hpp"

using namespace evbench;

namespace {

constexpr double kWarmUp = 0.1;  // [s] simulated before what is measured: pixels begin settled, real ones do not

struct Recording {
  std::vector<Event> events;
  double seconds() const { return 1e-6 * static_cast<double>(events.back().t - events.front().t); }
};

/// A constant motion: T_world_camera(t) = (exp(ω t), v t).
struct Drive {
  Vector3 omega = Vector3::Zero(), velocity = Vector3::Zero();
  SE3 operator()(double t) const { return {so3::exp(omega * t), velocity * t}; }
};

struct Case {
  std::string name, events, scene_text;
  Camera camera;
  Drive drive;
  RenderedSceneOptions scene;
};

Recording read_recording(EventStream&& stream) {
  Recording recording;
  for (std::vector<Event> chunk; stream.read(chunk);) {
    recording.events.insert(recording.events.end(), chunk.begin(), chunk.end());
  }
  return recording;
}

SimulatorOptions sensor() {
  SimulatorOptions options;
  options.sensor.threshold_on = 0.6;
  options.sensor.threshold_off = 0.45;
  options.sensor.threshold_mismatch = 0.06;
  options.sensor.refractory = 1e-3;
  options.sensor.noise_rate = 0.1;
  options.sensor.leak_rate = 0.2;
  options.sensor.jitter = 100e-6;
  return options;
}

Recording simulate(const Case& c, double seconds) {
  const double duration = kWarmUp + seconds;
  // The middle of the motion is where the scene is: the drive begins before it.
  const Motion motion = [drive = c.drive, half = 0.5 * duration](double t) { return drive(t - half); };
  auto scene = std::make_shared<const RenderedScene>(
      make_rendered_scene(c.scene, c.camera, motion, duration, Random(1), "", c.name));
  auto brightness = std::make_unique<SceneBrightness>(c.camera, scene, motion, RenderingOptions{}, 0);
  StreamOptions range;
  range.from = static_cast<std::int64_t>(kWarmUp * 1e6);
  return read_recording(
      EventStream(std::make_unique<EventSimulator>(std::move(brightness), sensor(), duration, 1), "simulation", range));
}

/// Quartiles of the times between a pixel's events [ms].
std::array<double, 3> inter_event_times(const Recording& recording) {
  std::map<std::pair<int, int>, std::int64_t> last;
  std::vector<double> gaps;
  for (const Event& event : recording.events) {
    const auto [found, fresh] = last.try_emplace({event.x, event.y}, event.t);
    if (!fresh) gaps.push_back(1e-3 * static_cast<double>(event.t - found->second));
    found->second = event.t;
  }
  std::ranges::sort(gaps);
  std::array<double, 3> quartiles{};
  for (std::size_t i = 0; i < 3 && !gaps.empty(); ++i) quartiles[i] = gaps[(i + 1) * (gaps.size() - 1) / 4];
  return quartiles;
}

/// Variance of the image of the first `count` events, each moved to where its point was at the first one's time if it
/// lay at `depth`; the drive's sign by `direction` (0: not moved).
double variance(const Recording& recording, const Case& c, std::size_t count, double depth, double direction) {
  std::vector<double> image(static_cast<std::size_t>(c.camera.width * c.camera.height));
  count = std::min(count, recording.events.size());
  for (std::size_t i = 0; i < count; ++i) {
    const Event& event = recording.events[i];
    const double dt = 1e-6 * static_cast<double>(event.t - recording.events.front().t);
    const std::optional<Vector2> ideal = c.camera.undistort(Vector2(event.x, event.y));
    if (!ideal) continue;
    const Vector3 point = c.drive(direction * dt) * (depth * c.camera.pinhole.ray(*ideal));
    const Vector2 pixel = c.camera.pinhole.project(point);
    if (!c.camera.contains(pixel, 1.0)) continue;
    const auto x = static_cast<int>(pixel.x()), y = static_cast<int>(pixel.y());
    const double fx = pixel.x() - x, fy = pixel.y() - y;
    const auto at = [&](int column, int row) -> double& {
      return image[static_cast<std::size_t>(row * c.camera.width + column)];
    };
    at(x, y) += (1 - fx) * (1 - fy);
    at(x + 1, y) += fx * (1 - fy);
    at(x, y + 1) += (1 - fx) * fy;
    at(x + 1, y + 1) += fx * fy;
  }
  double sum = 0.0, squares = 0.0;
  for (const double value : image) {
    sum += value;
    squares += value * value;
  }
  const auto n = static_cast<double>(image.size());
  return squares / n - sum * sum / (n * n);
}

/// Compensated over uncompensated, at the depth that suits best (rotations: any).
double sharpness(const Recording& recording, const Case& c) {
  constexpr std::size_t count = 15000;
  double best = 0.0;
  for (double depth = 0.2; depth < 3.0; depth *= 1.05) best = std::max(best, variance(recording, c, count, depth, 1.0));
  return best / variance(recording, c, count, 1.0, 0.0);
}

void print_row(const std::string& name, const Recording& recording, const Case& c) {
  const auto count = static_cast<double>(recording.events.size());
  const auto on = static_cast<double>(std::ranges::count(recording.events, true, &Event::on));
  const auto [low, middle, high] = inter_event_times(recording);
  fmt::print("| {} | {:.0f} | {:.3f} | {:.0f} | {:.1f} | {:.2f} / {:.2f} / {:.2f} | {:.2f} |\n", name, count,
             recording.seconds(), 1e-3 * count / recording.seconds(), 100.0 * on / count, low, middle, high,
             sharpness(recording, c));
}

Vector3 read_vector(const std::string& path) {
  Vector3 v = Vector3::Zero();
  std::ifstream(path) >> v.x() >> v.y() >> v.z();
  return v;
}

std::vector<Case> cases(const std::string& data) {
  const auto camera = [&](const std::string& name) { return read_calib(data + "/" + name + "/calib.txt", 240, 180); };
  Case slider{"slider_depth",
              data + "/slider_depth/events_chunk.txt",
              "boxes 0.35 to 0.9 m away",
              camera("slider_depth"),
              {},
              {}};
  slider.drive.velocity = {0.31, 0.0, 0.0};
  slider.scene = {.kind = "boxes", .near = 0.35, .far = 0.9, .boxes = 10, .detail = 0.05, .black = 0.2};
  Case shapes{
      "shapes_rotation", data + "/shapes_rotation/events_excerpt.txt", "shapes", camera("shapes_rotation"), {}, {}};
  shapes.drive.omega = read_vector(data + "/shapes_rotation/motion.txt");
  shapes.scene = {.kind = "shapes", .near = 0.8, .far = 1.6, .black = 0.1};
  Case office{"dynamic_rotation",
              data + "/dynamic_rotation/events_excerpt.txt",
              "boxes 1 to 4 m away",
              camera("dynamic_rotation"),
              {},
              {}};
  office.drive.omega = read_vector(data + "/dynamic_rotation/motion.txt");
  office.scene = {.kind = "boxes", .near = 1.0, .far = 4.0, .boxes = 20, .detail = 0.3, .black = 0.15};
  return {slider, shapes, office};
}

}  // namespace

int main() try {
  const char* const data = std::getenv("EVBENCH_DATA");
  if (data == nullptr) throw InputError("EVBENCH_DATA: is not set; expected the folder of real data");
  fmt::print(
      "| recording | events | time [s] | rate [1000/s] | ON [%] | between a pixel's events, quartiles [ms] | "
      "sharpness |\n| --- | --- | --- | --- | --- | --- | --- |\n");
  for (const Case& c : cases(data)) {
    StreamOptions options;
    options.read.width = c.camera.width;
    options.read.height = c.camera.height;
    const Recording real = read_recording(EventStream(c.events, options));
    if (real.events.empty()) throw InputError(fmt::format("{}: has no events", c.events));
    print_row(c.name + ", real", real, c);
    print_row(fmt::format("simulated: {}", c.scene_text), simulate(c, real.seconds()), c);
  }
  return 0;
} catch (const std::exception& error) {
  fmt::print(stderr, "event_reality: {}\n", error.what());
  return 1;
}
