// event_reality: compares simulated events with real ones. EVBENCH_DATA names the folder of real excerpts; the table
// goes to standard output as Markdown.
//
// The rule: a similar scene, along the same motion, with the same lens, all options at their defaults but one, the
// contrast threshold (ON and OFF alike). It is fitted on the first half of an excerpt so that the event rate there is
// the real one, by bisection; what is printed are measurements of the second half. dynamic_rotation, from the same
// camera as shapes_rotation, is also simulated with the threshold of that one: nothing is fitted to it.

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <opencv2/imgcodecs.hpp>

#include "core/data/calib.hpp"
#include "core/events/event_stream.hpp"
#include "core/geometry/so3.hpp"
#include "core/simulation/events/event_simulator.hpp"
#include "core/simulation/events/scene_brightness.hpp"
#include "core/support/error.hpp"
#include "core/support/index.hpp"

using namespace evbench;

namespace {

constexpr double kWarmUp = 0.05;  // [s] simulated before what is measured: pixels begin settled, real ones do not

/// Some events and the time that they were looked for [s].
struct Recording {
  std::vector<Event> events;
  double seconds = 0.0;
  double rate() const { return static_cast<double>(events.size()) / seconds; }
};

/// A constant motion: T_world_camera(t) = (exp(ω t), v t).
struct Drive {
  Vector3 omega = Vector3::Zero(), velocity = Vector3::Zero();
  SE3 operator()(double t) const { return {so3::exp(omega * t), velocity * t}; }
};

struct Case {
  std::string name, scene_text;
  Camera camera;
  Drive drive;
  RenderedSceneOptions scene;
  Recording first, second;  ///< halves of the excerpt
};

Recording read_recording(EventStream&& stream, double seconds) {
  Recording recording{{}, seconds};
  for (std::vector<Event> chunk; stream.read(chunk);) {
    recording.events.insert(recording.events.end(), chunk.begin(), chunk.end());
  }
  return recording;
}

void read_halves(Case& c, const std::string& path) {
  StreamOptions options;
  options.read.width = c.camera.width;
  options.read.height = c.camera.height;
  const std::vector<Event> events = read_recording(EventStream(path, options), 0.0).events;
  if (events.size() < 2) throw InputError(fmt::format("{}: has {} events; expected more", path, events.size()));
  const std::int64_t begin = events.front().t, end = events.back().t + 1, middle = (begin + end) / 2;
  const auto split = std::ranges::lower_bound(events, middle, {}, &Event::t);
  c.first = {{events.begin(), split}, 1e-6 * static_cast<double>(middle - begin)};
  c.second = {{split, events.end()}, 1e-6 * static_cast<double>(end - middle)};
}

/// The case's scene, ready to be simulated.
class Stage {
 public:
  explicit Stage(const Case& c) : case_(&c), duration_(kWarmUp + c.first.seconds + c.second.seconds) {
    // The scene is where the middle of the motion is: the drive begins before it.
    motion_ = [drive = c.drive, half = 0.5 * duration_](double t) { return drive(t - half); };
    scene_ = std::make_shared<const RenderedScene>(
        make_rendered_scene(c.scene, c.camera, motion_, duration_, Random(1), "", c.name));
  }

  Recording first_half(double threshold) const { return simulate(threshold, kWarmUp, kWarmUp + case_->first.seconds); }
  Recording second_half(double threshold) const {
    return simulate(threshold, kWarmUp + case_->first.seconds, duration_);
  }

  /// The threshold at which the first half has the real event rate, by bisection of its logarithm.
  double fit() const {
    constexpr int kSteps = 8;
    double low = 0.05, high = 2.0;
    for (int i = 0; i < kSteps; ++i) {
      const double middle = std::sqrt(low * high);
      (first_half(middle).rate() > case_->first.rate() ? low : high) = middle;
    }
    return std::sqrt(low * high);
  }

 private:
  Recording simulate(double threshold, double from, double to) const {
    SimulatorOptions options;
    options.sensor.threshold_on = options.sensor.threshold_off = threshold;
    auto brightness = std::make_unique<SceneBrightness>(case_->camera, scene_, motion_, RenderingOptions{}, 0);
    StreamOptions range;
    range.from = static_cast<std::int64_t>(from * 1e6);
    range.to = static_cast<std::int64_t>(to * 1e6);
    return read_recording(EventStream(std::make_unique<EventSimulator>(std::move(brightness), options, duration_, 1),
                                      "simulation", range),
                          to - from);
  }

  const Case* case_;
  double duration_;
  Motion motion_;
  std::shared_ptr<const RenderedScene> scene_;
};

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
    const auto at = [&](int column, int row) -> double& { return image[index(row * c.camera.width + column)]; };
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

/// The depth at which compensation makes the sharpest image, and how much sharper it is than without.
struct Sharpness {
  double depth = 0.0, gain = 0.0;
};
Sharpness sharpest(const Recording& recording, const Case& c) {
  constexpr std::size_t kCount = 8000;
  const double unmoved = variance(recording, c, kCount, 1.0, 0.0);
  Sharpness best;
  for (double depth = 0.2; depth < 3.0; depth *= 1.05) {
    const double gain = variance(recording, c, kCount, depth, 1.0) / unmoved;
    if (gain > best.gain) best = {depth, gain};
    if (c.drive.velocity.isZero()) break;  // rotations: any depth
  }
  return best;
}

void print_row(const std::string& name, const std::string& threshold, const Recording& recording, const Case& c) {
  const auto on = static_cast<double>(std::ranges::count(recording.events, true, &Event::on));
  const auto [low, middle, high] = inter_event_times(recording);
  fmt::print("| {} | {} | {:.0f} | {:.1f} | {:.2f} / {:.2f} / {:.2f} | {:.2f} |\n", name, threshold,
             1e-3 * recording.rate(), 100.0 * on / static_cast<double>(recording.events.size()), low, middle, high,
             sharpest(recording, c).gain);
  std::fflush(stdout);
}

Vector3 read_vector(const std::string& path) {
  Vector3 v = Vector3::Zero();
  if (!(std::ifstream(path) >> v.x() >> v.y() >> v.z())) {
    throw InputError(fmt::format("{}: can't be read; expected three numbers", path));
  }
  return v;
}

/// The camera's own picture, whose grey values are linear in the light, as a picture for displays.
void write_for_display(const std::string& from, const std::string& to) {
  cv::Mat picture = cv::imread(from, cv::IMREAD_GRAYSCALE);
  if (picture.empty()) throw InputError(fmt::format("{}: can't be read as a picture", from));
  picture.convertTo(picture, CV_64F, 1.0 / 255.0);
  cv::pow(picture, 1.0 / 2.2, picture);
  picture.convertTo(picture, CV_8U, 255.0);
  cv::imwrite(to, picture);
}

/// A plane with the recording's first frame, at the depth at which the first half's events compensate best.
Case slider_depth(const std::string& folder, const std::string& picture) {
  Case c{"slider_depth", "a plane with the real frame", read_calib(folder + "/calib.txt", 240, 180), {}, {}, {}, {}};
  c.drive.velocity = {0.31, 0.0, 0.0};
  read_halves(c, folder + "/events_chunk.txt");
  const double depth = sharpest(c.first, c).depth;
  write_for_display(folder + "/images/frame_00000000.png", picture);
  c.scene = {.near = 0.99 * depth, .far = 1.01 * depth, .picture = picture};
  c.scene.picture_width = c.camera.width / c.camera.pinhole.fx * depth;
  c.scene_text += fmt::format(" at {:.2f} m", depth);
  return c;
}

Case rotation(const std::string& folder, const std::string& name, const std::string& kind) {
  Case c{name, kind, read_calib(folder + "/calib.txt", 240, 180), {}, {}, {}, {}};
  c.drive.omega = read_vector(folder + "/motion.txt");
  read_halves(c, folder + "/events_excerpt.txt");
  c.scene.kind = kind;
  return c;
}

/// Real, fitted, and with the threshold of another recording of the same camera; returns the fitted one.
double compare(const Case& c, double other = 0.0, const std::string& other_name = "") {
  print_row(c.name + ", real", "", c.second, c);
  const Stage stage(c);
  const double threshold = stage.fit();
  print_row("simulated: " + c.scene_text, fmt::format("{:.2f}", threshold), stage.second_half(threshold), c);
  if (other > 0.0) {
    print_row("simulated: " + c.scene_text, fmt::format("{:.2f}, from {}", other, other_name), stage.second_half(other),
              c);
  }
  return threshold;
}

}  // namespace

int main() try {
  const char* const data = std::getenv("EVBENCH_DATA");
  if (data == nullptr) throw InputError("EVBENCH_DATA: is not set; expected the folder of real data");
  const std::string folder = data;
  fmt::print(
      "| second half of | threshold | rate [1000/s] | ON [%] | between a pixel's events, quartiles [ms] | sharpness |\n"
      "| --- | --- | --- | --- | --- | --- |\n");
  const std::string picture = std::filesystem::temp_directory_path() / fmt::format("event_reality_{}.png", ::getpid());
  const Case slider = slider_depth(folder + "/slider_depth", picture);
  compare(slider);
  std::filesystem::remove(picture);
  const double threshold = compare(rotation(folder + "/shapes_rotation", "shapes_rotation", "shapes"));
  compare(rotation(folder + "/dynamic_rotation", "dynamic_rotation", "boxes"), threshold, "shapes_rotation");
  return 0;
} catch (const std::exception& error) {
  fmt::print(stderr, "event_reality: {}\n", error.what());
  return 1;
}
