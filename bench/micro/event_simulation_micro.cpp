// What simulating events costs:
//
//   event_simulation_micro [MILLIONS [THREADS [CASE]]]
//
// until each case, or those whose name has CASE in it, have made that many million events (5), on so many threads (2).
//
// A textured plane, boxes in a room and shapes, with the default sensor, seen along smooth random motion; larger
// sensors with the same field of view. "rendering": processor time of whole pictures; "pixels": that of all else, the
// pixel model, the pictures' single pixels that it asks for, and sorting.

#include <fmt/format.h>

#include <chrono>
#include <cstdlib>
#include <string>

#include "bench/micro/reading_speed.hpp"
#include "core/simulation/events/event_simulator.hpp"
#include "core/simulation/events/scene_brightness.hpp"
#include "core/support/peak_memory.hpp"

namespace {

using namespace evbench;

constexpr double kDuration = 60.0;  // [s] that a case may take of the motion; none needs as much

/// A brightness whose pictures are counted and timed.
class Timed : public Brightness {
 public:
  struct Cost {
    int pictures = 0;
    double processor_s = 0.0;
  };
  Timed(SceneBrightness brightness, Cost& cost) : brightness_(std::move(brightness)), cost_(&cost) {}

  int width() const override { return brightness_.width(); }
  int height() const override { return brightness_.height(); }
  void start(double t) override { brightness_.start(t); }
  double advance(double limit) override {
    const double start = processor_seconds(), end = brightness_.advance(limit);
    cost_->processor_s += processor_seconds() - start;
    ++cost_->pictures;
    return end;
  }
  std::span<const float> image() const override { return brightness_.image(); }
  float within(int x, int y, int part) const override { return brightness_.within(x, y, part); }

 private:
  SceneBrightness brightness_;
  Cost* cost_;
};

struct Case {
  std::string scene;
  int width, height;
  std::string name() const { return fmt::format("{} {}x{}", scene, width, height); }
};

void run(const Case& c, std::int64_t wanted, int threads) {
  Camera camera;
  camera.width = c.width;
  camera.height = c.height;
  const double focal_length = 200.0 / 240.0 * c.width;
  camera.pinhole = {focal_length, focal_length, 0.5 * (c.width - 1), 0.5 * (c.height - 1)};
  MotionOptions motion_options;
  motion_options.kind = "smooth_random";
  const Motion motion = make_motion(motion_options, kDuration, 1, "", "motion");
  RenderedSceneOptions scene_options;
  scene_options.kind = c.scene;
  const auto scene = std::make_shared<const RenderedScene>(
      make_rendered_scene(scene_options, camera, motion, kDuration, Random(1), "", "scene"));
  Timed::Cost rendering;
  SimulatorOptions options;
  options.threads = threads;
  EventSimulator simulator(
      std::make_unique<Timed>(SceneBrightness(camera, scene, motion, RenderingOptions{}, threads), rendering), options,
      kDuration, 1);

  const auto start = std::chrono::steady_clock::now();
  const double processor_start = processor_seconds();
  std::int64_t count = 0;
  double simulated = 0.0;
  for (std::vector<Event> events; count < wanted && simulator.read(events);) {
    count += static_cast<std::int64_t>(events.size());
    simulated = 1e-6 * static_cast<double>(events.back().t);
  }
  const double wall = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  const double processor = processor_seconds() - processor_start, pixels = processor - rendering.processor_s;
  const auto millions = 1e-6 * static_cast<double>(count);
  fmt::print("| {} | {:.2f} | {:.3f} | {} | {:.2f} | {:.2f} | {:.2f} | {:.2f} | {:.1f} | {:.0f} |\n", c.name(),
             millions, simulated, rendering.pictures, wall, processor, millions / processor, pixels,
             1e3 * rendering.processor_s / rendering.pictures, peak_memory_mib());
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) try {
  const double millions = argc > 1 ? std::atof(argv[1]) : 5.0;
  const int threads = argc > 2 ? std::atoi(argv[2]) : 2;
  fmt::print(
      "| scene | million events | simulated [s] | pictures | wall [s] | processor [s] | M events/s of processor time | "
      "of it pixels [s] | rendering [ms a picture] | peak memory so far [MiB] |\n"
      "| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |\n");
  for (const Case& c :
       {Case{"plane", 240, 180}, Case{"boxes", 240, 180}, Case{"shapes", 240, 180}, Case{"plane", 346, 260},
        Case{"plane", 640, 480}, Case{"plane", 1280, 720}, Case{"boxes", 1280, 720}}) {
    if (c.name().find(argc > 3 ? argv[3] : "") == std::string::npos) continue;
    run(c, static_cast<std::int64_t>(1e6 * millions), threads);
  }
  return 0;
} catch (const std::exception& error) {
  fmt::print(stderr, "event_simulation_micro: {}\n", error.what());
  return 1;
}
