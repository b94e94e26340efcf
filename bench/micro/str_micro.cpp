// Cost and error of registration:
//
//   str_micro [SECONDS]
//
// of simulated events of a camera that rotates at 2 rad/s before geometric shapes (SECONDS: 0.1), on three sensors with
// the same horizontal field of view. Batches of 10 and 20 px of motion, each started from the last one's, with all
// events of the first slice as queries and with 1,000; as they are, and thinned to as many events as the smallest
// sensor's batches have. Times are the processor's, the least of five runs over three million events or a few more.
// For comparison: a direct implementation of contrast maximisation (testing/contrast.hpp) on the smallest sensor's
// first five batches.

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <ctime>

#include "core/support/error.hpp"
#include "core/support/median.hpp"
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
  constexpr std::size_t kEnough = 3'000'000;  // events
  const double duration = pixels / (recording.camera.pinhole.fx * recording.omega.norm());
  const auto length = static_cast<std::int64_t>(1e6 * duration);
  std::vector<Batch> result;
  const std::span<const Event> events = recording.events;
  std::size_t count = 0;
  for (std::int64_t from = 0; from + length <= events.back().t && count < kEnough; from += length) {
    const auto first = std::ranges::lower_bound(events, from, {}, &Event::t);
    const auto last = std::ranges::lower_bound(events, from + length, {}, &Event::t);
    result.push_back({{first, last}, from, from + length});
    count += result.back().events.size();
  }
  if (result.empty()) throw InputError(fmt::format("no batch moves by {} px; expected more SECONDS", pixels));
  return result;
}

/// Events in a batch.
std::size_t mean_size(const std::vector<Batch>& batches) {
  std::size_t sum = 0;
  for (const Batch& batch : batches) sum += batch.events.size();
  return sum / batches.size();
}

double error(const Matrix3& A, const Vector3& omega) {
  return 100.0 * (Vector3(project_onto(MotionModel::rotation, A)) - omega).norm() / omega.norm();
}

void print_row(const RotationRecording& recording, double pixels, std::size_t size, const std::string& method,
               const std::vector<double>& errors, double seconds_an_event) {
  fmt::print("| {}x{} | {:.0f} | {} | {} | {:.2f} | {:.2f} |\n", recording.camera.width, recording.camera.height,
             pixels, size, method, median(errors), 1e-6 / seconds_an_event);
  std::fflush(stdout);
}

void measure(const RotationRecording& recording, double pixels, int queries) {
  const std::vector<Batch> all = batches(recording, pixels);
  RegistrationOptions options;
  options.queries = queries;
  Registrar registrar(recording.camera, options);
  double best = 1e9;
  std::vector<double> errors;
  for (int run = 0; run < 5; ++run) {
    errors.clear();
    std::optional<Matrix3> last = generator_matrix(MotionModel::rotation, recording.omega);
    const double start = now();
    for (const Batch& batch : all) {
      const Registration found = registrar.align(batch, last);
      last = found.A;
      errors.push_back(error(found.A, recording.omega));
    }
    best = std::min(best, now() - start);
  }
  const std::size_t size = mean_size(all);
  print_row(recording, pixels, size, queries == 0 ? "all queries" : fmt::format("{} queries", queries), errors,
            best / static_cast<double>(size * all.size()));
}

void measure_contrast(const RotationRecording& recording, double pixels) {
  std::vector<Batch> some = batches(recording, pixels);
  if (some.size() > 5) some.resize(5);
  const RayTable rays(recording.camera);
  std::vector<double> errors;
  double time = 0.0;
  for (const Batch& batch : some) {
    EventCloud cloud;
    make_cloud(batch.events, rays, (batch.from + batch.to) / 2, cloud);
    const double start = now();
    const MotionParameters theta =
        testing::maximise_contrast(cloud, MotionModel::rotation, 0.95 * recording.omega, 0.1, rays.focal_length());
    time += now() - start;
    errors.push_back(error(generator_matrix(MotionModel::rotation, theta), recording.omega));
  }
  const std::size_t size = mean_size(some);
  print_row(recording, pixels, size, "contrast maximisation", errors, time / static_cast<double>(size * some.size()));
}

/// This share of the events, evenly taken.
RotationRecording thinned(const RotationRecording& recording, double share) {
  RotationRecording result{recording.camera, recording.omega, {}};
  const auto count = static_cast<std::size_t>(share * static_cast<double>(recording.events.size()));
  for (std::size_t i = 0; i < count; ++i) {
    result.events.push_back(recording.events[i * recording.events.size() / count]);
  }
  return result;
}

}  // namespace

int main(int argc, char** argv) try {
  const double seconds = argc > 1 ? std::atof(argv[1]) : 0.1;
  if (!(seconds > 0.0)) throw InputError("usage: str_micro [SECONDS], more than 0");
  fmt::print(
      "| sensor | px a batch | events a batch | method | error, median [%] | million events/s |\n"
      "| --- | ---: | ---: | --- | ---: | ---: |\n");
  std::size_t of_smallest = 0;  // events in a batch
  for (const auto& [width, height] : {std::pair{240, 180}, {640, 480}, {1280, 720}}) {
    const RotationRecording recording =
        testing::simulate_rotation("shapes", width, height, 2.0 * Vector3(0.5, 0.8, 0.33).normalized(), seconds, 1);
    const std::size_t size = mean_size(batches(recording, 10.0));
    const bool smallest = of_smallest == 0;
    if (smallest) of_smallest = size;
    for (const double pixels : {10.0, 20.0}) {
      for (const int queries : {0, 1000}) measure(recording, pixels, queries);
      if (smallest) measure_contrast(recording, pixels);
    }
    if (smallest) continue;
    const RotationRecording few = thinned(recording, static_cast<double>(of_smallest) / static_cast<double>(size));
    for (const double pixels : {10.0, 20.0}) {
      for (const int queries : {0, 1000}) measure(few, pixels, queries);
    }
  }
  return 0;
} catch (const std::exception& error) {
  fmt::print(stderr, "str_micro: {}\n", error.what());
  return 1;
}
