#include "bench/recordings/conversion.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iterator>

#include "bench/recordings/own_calibration.hpp"
#include "core/data/calib.hpp"
#include "core/events/formats.hpp"
#include "core/events/writer.hpp"
#include "core/io/atomic_file.hpp"
#include "core/io/part_file.hpp"
#include "core/support/error.hpp"
#include "core/support/interruption.hpp"
#include "core/support/nearest.hpp"

namespace evbench {
namespace {

/// Where a lens' pixels lie in the ideal pinhole's image, to the nearest pixel.
class NearestUndistortion {
 public:
  explicit NearestUndistortion(const Camera& camera) : width_(static_cast<std::size_t>(camera.width)) {
    for (int y = 0; y < camera.height; ++y) {
      for (int x = 0; x < camera.width; ++x) table_.push_back(undistort(camera, x, y));
    }
  }

  /// Moves events; returns the number that is now outside and left out.
  std::int64_t apply(std::vector<Event>& events) const {
    return static_cast<std::int64_t>(std::erase_if(events, [&](Event& event) {
      const Pixel pixel = table_[event.y * width_ + event.x];
      if (pixel.x == kOutside) return true;
      event.x = static_cast<std::uint16_t>(pixel.x);
      event.y = static_cast<std::uint16_t>(pixel.y);
      return false;
    }));
  }

 private:
  static constexpr std::int32_t kOutside = -1;
  struct Pixel {
    std::int32_t x = kOutside, y = kOutside;
  };

  static Pixel undistort(const Camera& camera, int x, int y) {
    const std::optional<Vector2> ideal = camera.undistort(Vector2(x, y));
    if (!ideal) return {};
    const Vector2 nearest(std::round(ideal->x()), std::round(ideal->y()));
    if (!camera.contains(nearest)) return {};
    return {static_cast<std::int32_t>(nearest.x()), static_cast<std::int32_t>(nearest.y())};
  }

  std::size_t width_;
  std::vector<Pixel> table_;
};

const WritableFormat& find_format(const std::string& out, const std::string& name) {
  const std::string extension = std::filesystem::path(out).extension().string();
  std::vector<std::string> names, known;
  for (const WritableFormat& format : writable_formats()) {
    if (name.empty() ? format.extension == extension : format.name == name) return format;
    names.push_back(format.name);
    known.push_back(fmt::format("{} ({})", format.extension, format.name));
  }
  if (!name.empty()) throw InputError(fmt::format("--format: is \"{}\"{}", name, suggestion(name, names)));
  throw InputError(fmt::format("{}: the extension says no format that can be written; expected one of {}, or --format",
                               out, fmt::join(known, ", ")));
}

PoseTrajectory shifted(const PoseTrajectory& trajectory, double by) {
  std::vector<StampedPose> poses = trajectory.poses();
  for (StampedPose& pose : poses) pose.t += by;
  return PoseTrajectory(std::move(poses));
}

std::string range_text(const StreamOptions& options) {
  const auto seconds = [](std::int64_t t) { return static_cast<double>(t) * 1e-6; };
  if (!options.from) return fmt::format("up to {:.6f} s", seconds(*options.to));
  if (!options.to) return fmt::format("from {:.6f} s on", seconds(*options.from));
  return fmt::format("{:.6f} to {:.6f} s", seconds(*options.from), seconds(*options.to));
}

RecordingHeader make_header(EventStream& stream, const std::string& in, const StreamOptions& options) {
  RecordingHeader header;
  header.width = stream.info().width;
  header.height = stream.info().height;
  OwnCalibration own = own_calibration(stream.reader(), options.read.strict);
  header.calibration = own.calibration;
  if (own.ground_truth) {
    constexpr double kMargin = 1.0;  // [s], so that poses can be interpolated at the ends
    const PoseTrajectory truth = shifted(*own.ground_truth, -1e-6 * static_cast<double>(stream.zero()));
    const double from = options.from ? 1e-6 * static_cast<double>(*options.from) - kMargin : truth.start();
    const double to = options.to ? 1e-6 * static_cast<double>(*options.to) + kMargin : truth.end();
    header.ground_truth = truth.cut(from, to);
  }
  header.metadata = stream.info().metadata;  // with remarks on the events read just now
  header.metadata.insert(header.metadata.end(), own.unusable.begin(), own.unusable.end());
  header.metadata.emplace_back("converted from", fmt::format("{} ({})", in, stream.info().format));
  if (options.from || options.to) header.metadata.emplace_back("a part of it", range_text(options));
  return header;
}

bool fits(const Camera& camera, const RecordingHeader& header) {
  return camera.width == header.width && camera.height == header.height;
}

/// The lens to be removed; the header then has none.
Camera take_lens(const ConversionOptions& options, const std::string& in, RecordingHeader& header) {
  const std::string& calibration = options.undistort;
  if (header.width <= 0 || header.height <= 0) {
    throw InputError(
        fmt::format("{}: does not say the sensor's size, which --undistort needs; give --width, --height", in));
  }
  if (calibration == "own" && !header.calibration) {
    throw InputError(fmt::format("{}: has no calibration of its own; give a calib.txt to --undistort", in));
  }
  const Camera lens = calibration == "own" ? *header.calibration
                                           : read_calib(calibration, header.width, header.height,
                                                        DistortionModel::radial_tangential, options.camera);
  if (!fits(lens, header)) {
    throw InputError(fmt::format("{}: calibration of {}x{} pixels; expected the sensor's {}x{}", in, lens.width,
                                 lens.height, header.width, header.height));
  }
  header.calibration = Camera{lens.pinhole, DistortionModel::none, {}, lens.width, lens.height};
  header.calibration->coefficients.setZero();
  header.metadata.emplace_back("undistorted", "to the nearest pixel");
  return lens;
}

/// Refuses a calibration of another sensor.
void drop_misfit(RecordingHeader& header) {
  if (!header.calibration || header.width <= 0 || fits(*header.calibration, header)) return;
  const Camera& camera = *header.calibration;
  header.metadata.emplace_back("calibration left out", fmt::format("of {}x{} pixels", camera.width, camera.height));
  header.calibration.reset();
}

/// The reason why no event was left to be written.
const char* why_none(const StreamOptions& options, const ConversionReport& report) {
  if (report.outside > 0) return "all events lie outside the undistorted image";
  if (options.from || options.to) return "has no events in the time range that is asked for";
  return report.faults.empty() ? "has no events" : "all events are faulty";
}

}  // namespace

ConversionReport convert(const std::string& in, const std::string& out, const ConversionOptions& options,
                         const std::function<void(std::int64_t, std::int64_t)>& progress) {
  const WritableFormat& format = find_format(out, options.format);
  EventStream stream(in, options.stream);
  RecordingHeader header = make_header(stream, in, options.stream);
  std::vector<std::string> inputs = stream.reader().companion_files();
  std::ranges::move(files_of_events(in), std::back_inserter(inputs));
  inputs.push_back(options.undistort);
  check_outputs({out}, inputs, options.force);
  std::optional<NearestUndistortion> undistortion;
  if (!options.undistort.empty()) undistortion.emplace(take_lens(options, in, header));
  drop_misfit(header);

  PartFile file(out, format.needs);
  ConversionReport report;
  report.format = format.name;
  for (const auto& [key, text] : header.metadata) {
    if (key == kUnusableCalibration || key == kUnusableGroundTruth)
      report.unusable.push_back(fmt::format("{}: {}", key, text));
  }
  std::int64_t read = 0;
  {
    const auto writer = format.make(file.writable_path(), out, header);
    for (std::vector<Event> events; stream.read(events);) {
      read += static_cast<std::int64_t>(events.size());
      const std::int64_t reached = events.back().t;
      if (undistortion) report.outside += undistortion->apply(events);
      report.written += static_cast<std::int64_t>(events.size());
      writer->write(events);
      if (progress) progress(read, reached);
    }
    writer->finish();
  }
  check_interruption();
  report.faults = stream.faults();
  if (report.written == 0) {
    throw InputError(fmt::format("{}: {}; nothing was written", in, why_none(options.stream, report)));
  }
  file.commit();
  return report;
}

}  // namespace evbench
