// Ablation of the registration, each choice compared with the default:
//
//   str_ablation [SEEDS]
//
// of simulated events (240x180) of a camera that rotates at 2 rad/s before geometric shapes and before fallen leaves,
// over SEEDS recordings of each (2). Batches of 5 and 10 px of motion, each aligned once from nine tenths of the true
// motion (median error; in brackets by how much the motion is found too small or too large along its own axis, median)
// and once from rest, without growing batches (share of the batches within 5 %).

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <functional>

#include "core/support/error.hpp"
#include "core/support/median.hpp"
#include "frontends/str/registration/registration.hpp"
#include "frontends/str/registration/testing/rotation_recording.hpp"

namespace {

using namespace evbench;
using namespace evbench::str;
using evbench::str::testing::RotationRecording;

/// The events of a batch's two slices, and when [s] since the batch's middle the slices have theirs.
struct Slices {
  EventCloud first, last;
  float first_middle, last_middle;
};

struct Variant {
  std::string name;
  std::function<void(RegistrationOptions&)> choose;      ///< a change by options
  std::function<void(Slices&)> change = [](Slices&) {};  ///< a change that no option makes
};

std::vector<Variant> variants() {
  const auto nothing = [](RegistrationOptions&) {};
  const auto thinned = [](std::size_t count) {
    return [count](Slices& slices) {
      slices.first = take_evenly(slices.first, count);
      slices.last = take_evenly(slices.last, count);
    };
  };
  const auto at_once = [](Slices& slices) {
    std::ranges::fill(slices.first.t, slices.first_middle);
    std::ranges::fill(slices.last.t, slices.last_middle);
  };
  std::vector<Variant> result = {
      {"default: own times, line distances, polarity, a quarter, all queries", nothing},
      {"slices as instants", nothing, at_once},
      {"last slice as an instant", nothing,
       [](Slices& slices) { std::ranges::fill(slices.last.t, slices.last_middle); }},
  };
  for (const double slice : {0.1, 0.2, 0.3, 0.4, 0.5}) {
    result.push_back({fmt::format("slices of {}", slice), [slice](auto& options) { options.slice = slice; }});
  }
  result.push_back({"polarity ignored", [](auto& options) { options.alignment.polarity = false; }});
  for (const double keep : {0.95, 0.8, 0.6, 0.3}) {
    result.push_back({fmt::format("trim: {} kept", keep), [keep](auto& options) { options.alignment.keep = keep; }});
  }
  for (const int queries : {1000, 300}) {
    result.push_back({fmt::format("{} queries", queries), [queries](auto& options) { options.queries = queries; }});
  }
  for (const std::size_t count : {std::size_t{1000}, std::size_t{300}}) {
    result.push_back({fmt::format("both slices thinned to {}", count), nothing, thinned(count)});
  }
  const auto by_points = [](RegistrationOptions& options) {
    options.alignment.distance = AlignmentOptions::Distance::point;
  };
  result.push_back({"point distances", by_points});
  result.push_back({"point distances, slices as instants", by_points, at_once});
  result.push_back({"point distances, both slices thinned to 1000", by_points, thinned(1000)});
  return result;
}

std::span<const Event> between(std::span<const Event> events, std::int64_t from, std::int64_t to) {
  const auto first = std::ranges::lower_bound(events, from, {}, &Event::t);
  return {first, std::ranges::lower_bound(first, events.end(), to, {}, &Event::t)};
}

struct Errors {
  std::vector<double> sizes, along;  ///< [%] of the motion
  std::size_t batches = 0, from_rest = 0;
};

void measure(const RotationRecording& recording, double pixels, const Variant& variant, Errors& errors) {
  RegistrationOptions options;
  options.queries = 0;
  variant.choose(options);
  const RayTable rays(recording.camera);
  Aligner aligner(options.alignment, rays.focal_length());
  const double duration = pixels / (recording.camera.pinhole.fx * recording.omega.norm());
  const auto length = static_cast<std::int64_t>(1e6 * duration);
  const auto slice = static_cast<std::int64_t>(options.slice * static_cast<double>(length));
  const Matrix3 truth = generator_matrix(MotionModel::rotation, recording.omega);
  const auto error = [&](const Alignment& found) {
    return Vector3((project_onto(MotionModel::rotation, found.A) - recording.omega) / recording.omega.norm());
  };
  for (std::int64_t from = 0; from + length <= recording.events.back().t; from += length) {
    const std::int64_t middle = from + length / 2;
    const float offset = 1e-6F * static_cast<float>(length - slice) / 2.0F;
    Slices slices{{}, {}, -offset, offset};
    make_cloud(between(recording.events, from, from + slice), rays, middle, slices.first);
    make_cloud(between(recording.events, from + length - slice, from + length), rays, middle, slices.last);
    variant.change(slices);
    if (options.queries > 0) slices.first = take_evenly(slices.first, static_cast<std::size_t>(options.queries));
    aligner.swap_targets(slices.last);
    const auto align = [&](const Matrix3& start) {
      return error(aligner.align(slices.first, MotionModel::rotation, start, duration, options.alignment.gate));
    };
    const Vector3 near = align(0.9 * truth);
    errors.sizes.push_back(100.0 * near.norm());
    errors.along.push_back(100.0 * near.dot(recording.omega.normalized()));
    errors.from_rest += align(Matrix3::Zero()).norm() < 0.05 ? 1 : 0;
    ++errors.batches;
  }
}

}  // namespace

int main(int argc, char** argv) try {
  const int seeds = argc > 1 ? std::atoi(argv[1]) : 2;
  if (seeds < 1) throw InputError("usage: str_ablation [SEEDS], at least 1");
  const Vector3 omega = 2.0 * Vector3(0.5, 0.8, 0.33).normalized();
  std::vector<std::vector<RotationRecording>> scenes;
  std::string header = "| what |", line = "| --- |";
  for (const auto& [kind, name] : {std::pair{"shapes", "shapes"}, {"plane", "leaves"}}) {
    std::vector<RotationRecording>& recordings = scenes.emplace_back();
    for (int seed = 1; seed <= seeds; ++seed) {
      recordings.push_back(testing::simulate_rotation(kind, 240, 180, omega, 0.25, static_cast<std::uint64_t>(seed)));
    }
    for (const int pixels : {5, 10}) {
      header += fmt::format(" {}, {} px: error (along) [%] | from rest [%] |", name, pixels);
      line += " ---: | ---: |";
    }
  }
  fmt::print("{}\n{}\n", header, line);
  for (const Variant& variant : variants()) {
    fmt::print("| {} |", variant.name);
    for (const std::vector<RotationRecording>& recordings : scenes) {
      for (const double pixels : {5.0, 10.0}) {
        Errors errors;
        for (const RotationRecording& recording : recordings) measure(recording, pixels, variant, errors);
        fmt::print(" {:.1f} ({:+.1f}) | {:.0f} |", median(errors.sizes), median(errors.along),
                   100.0 * static_cast<double>(errors.from_rest) / static_cast<double>(errors.batches));
      }
    }
    fmt::print("\n");
    std::fflush(stdout);
  }
  return 0;
} catch (const std::exception& error) {
  fmt::print(stderr, "str_ablation: {}\n", error.what());
  return 1;
}
