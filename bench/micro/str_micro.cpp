// What registration costs and how far off it is:
//
//   str_micro [SECONDS]
//
// of simulated events of a camera that rotates at 2 rad/s before geometric shapes (SECONDS: 0.2), at three resolutions
// with the same field of view. Batches of 10 and 20 px of motion, each started from the last one's, with all events of
// the first slice as queries and with 1,000; times are the processor's, the least of five runs. Beside it contrast
// maximisation of the same batches, as it is written down (testing/contrast.hpp), of the first five.

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <ctime>

#include "frontends/str/registration/registration.hpp"
#include "frontends/str/registration/testing/contrast.hpp"
#include "frontends/str/registration/testing/rotation_recording.hpp"

namespace {

using namespace evbench;
using namespace evbench::str;
using evbench::str::testing::RotationRecording;

/// Processor time of this thread [s]: the machine may have other work.
double now() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

std::vector<Batch> batches(const RotationRecording& recording, double pixels) {
  const double duration = pixels / (recording.camera.pinhole.fx * recording.omega.norm());
  const auto length = static_cast<std::int64_t>(1e6 * duration);
  std::vector<Batch> result;
  const std::span<const Event> events = recording.events;
  for (std::int64_t from = 0; from + length <= events.back().t; from += length) {
    const auto first = std::ranges::lower_bound(events, from, {}, &Event::t);
    const auto last = std::ranges::lower_bound(events, from + length, {}, &Event::t);
    result.push_back({{first, last}, from, from + length});
  }
  return result;
}

double error(const Matrix3& A, const Vector3& omega) {
  return 100.0 * (Vector3(project_onto(MotionModel::rotation, A)) - omega).norm() / omega.norm();
}

double median(std::vector<double> values) {
  if (values.empty()) return 0.0;
  std::ranges::nth_element(values, values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2));
  return values[values.size() / 2];
}

void measure(const RotationRecording& recording, double pixels, int queries) {
  const std::vector<Batch> all = batches(recording, pixels);
  RegistrationOptions options;
  options.queries = queries;
  Registrar registrar(recording.camera, options);
  double best = 1e9;
  std::vector<double> errors;
  std::size_t events = 0;
  for (int run = 0; run < 5; ++run) {
    errors.clear();
    events = 0;
    std::optional<Matrix3> last = generator_matrix(MotionModel::rotation, recording.omega);
    const double start = now();
    for (const Batch& batch : all) {
      const Registration found = registrar.align(batch, last);
      last = found.A;
      events += batch.events.size();
      errors.push_back(error(found.A, recording.omega));
    }
    best = std::min(best, now() - start);
  }
  double contrast_time = 0.0;
  std::vector<double> contrast_errors;
  for (std::size_t i = 0; i < std::min<std::size_t>(all.size(), 5) && queries == 0; ++i) {
    EventCloud cloud;
    make_cloud(all[i].events, registrar.rays(), (all[i].from + all[i].to) / 2, 0, cloud);
    const double start = now();
    const MotionParameters theta = testing::maximise_contrast(cloud, MotionModel::rotation, 0.95 * recording.omega, 0.1,
                                                              registrar.rays().focal_length());
    contrast_time += (now() - start) / static_cast<double>(all[i].events.size());
    contrast_errors.push_back(error(generator_matrix(MotionModel::rotation, theta), recording.omega));
  }
  const std::string contrast = queries == 0
                                   ? fmt::format("{:.2f} | {:.3f}", median(contrast_errors),
                                                 1e-6 * static_cast<double>(contrast_errors.size()) / contrast_time)
                                   : " | ";
  fmt::print("| {}x{} | {:.0f} | {} | {} | {:.2f} | {:.2f} | {} |\n", recording.camera.width, recording.camera.height,
             pixels, events / all.size(), queries == 0 ? "all" : std::to_string(queries), median(errors),
             1e-6 * static_cast<double>(events) / best, contrast);
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) try {
  const double seconds = argc > 1 ? std::atof(argv[1]) : 0.2;
  fmt::print(
      "| sensor | px a batch | events a batch | queries | error, median [%] | million events/s | contrast: error [%] | "
      "million events/s |\n| --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: |\n");
  for (const int width : {240, 640, 1280}) {
    const RotationRecording recording =
        testing::simulate_rotation("shapes", width, 2.0 * Vector3(0.5, 0.8, 0.33).normalized(), seconds, 1);
    for (const double pixels : {10.0, 20.0}) {
      for (const int queries : {0, 1000}) measure(recording, pixels, queries);
    }
  }
  return 0;
} catch (const std::exception& error) {
  fmt::print(stderr, "str_micro: {}\n", error.what());
  return 1;
}
