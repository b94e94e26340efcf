#include "core/events/ros/camera_info.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "core/data/calibration_fields.hpp"
#include "core/support/error.hpp"

namespace evbench::ros {

bool is_calibrated(const CameraInfo& info) {
  return !std::ranges::all_of(info.K, [](double number) { return number == 0.0; });
}

Camera camera_of(const CameraInfo& info, const std::string& topic, int width, int height) {
  const auto side = [&](std::uint32_t stated, int usual) { return stated > 0 ? checked_side(topic, stated) : usual; };
  if (info.is_partial) {
    throw InputError(
        fmt::format("{}: is of a binned image or of a region of interest; expected one of the whole sensor", topic));
  }
  const DistortionModel distortion = named_distortion(topic + ": distortion_model", info.distortion_model);
  const bool bends = std::ranges::any_of(info.D, [](double coefficient) { return coefficient != 0.0; });
  if (distortion == DistortionModel::none && bends) {
    throw InputError(
        fmt::format("{}: has lens coefficients and the distortion_model \"{}\"; expected the name of theirs", topic,
                    info.distortion_model));
  }
  return checked_camera(fmt::format("{} ({})", topic, info.distortion_model), matrix_intrinsics(topic, info.K),
                        distortion, info.D, side(info.width, width), side(info.height, height));
}

}  // namespace evbench::ros
