#include "core/events/native/metadata.hpp"

#include <fmt/format.h>

#include "core/support/error.hpp"
#include "core/support/index.hpp"
#include "core/support/json.hpp"

namespace evbench::native {
namespace {

Json to_json(const Camera& camera) {
  const PinholeCamera& p = camera.pinhole;
  const auto& k = camera.coefficients;
  return {{"pinhole", {p.fx, p.fy, p.cx, p.cy}},
          {"distortion", to_string(camera.distortion)},
          {"coefficients", std::vector<double>(k.data(), k.data() + k.size())}};
}

Camera to_camera(const Json& json, int width, int height) {
  Camera camera;
  const Json& p = json.at("pinhole");
  camera.pinhole = {p.at(0).get<double>(), p.at(1).get<double>(), p.at(2).get<double>(), p.at(3).get<double>()};
  camera.distortion = parse_distortion_model(json.at("distortion").get<std::string>());
  for (int i = 0; i < 5; ++i) camera.coefficients[i] = json.at("coefficients").at(index(i)).get<double>();
  camera.width = width;
  camera.height = height;
  return camera;
}

/// As in TUM's files: t px py pz qx qy qz qw.
Json to_json(const PoseTrajectory& trajectory) {
  Json poses = Json::array();
  for (const auto& [t, T] : trajectory.poses()) {
    poses.push_back({t, T.p.x(), T.p.y(), T.p.z(), T.q.x(), T.q.y(), T.q.z(), T.q.w()});
  }
  return poses;
}

PoseTrajectory to_trajectory(const Json& json) {
  std::vector<StampedPose> poses;
  for (const Json& row : json) {
    const auto v = row.get<std::array<double, 8>>();
    poses.push_back({v[0], {Eigen::Quaterniond(v[7], v[4], v[5], v[6]), Vector3(v[1], v[2], v[3])}});
  }
  return PoseTrajectory(std::move(poses));
}

}  // namespace

std::string format_metadata(const RecordingHeader& recording) {
  Json json = {{"fields", recording.metadata}};
  if (recording.calibration) json["calibration"] = to_json(*recording.calibration);
  if (!recording.ground_truth.empty()) json["ground_truth"] = to_json(recording.ground_truth);
  return printable_json(json);
}

RecordingHeader parse_metadata(std::span<const std::byte> text, int width, int height, const std::string& name) {
  RecordingHeader recording;
  recording.width = width;
  recording.height = height;
  try {
    const auto* const first = reinterpret_cast<const char*>(text.data());
    const Json json = parse_json({first, text.size()});
    json.at("fields").get_to(recording.metadata);
    if (json.contains("calibration")) recording.calibration = to_camera(json.at("calibration"), width, height);
    if (json.contains("ground_truth")) recording.ground_truth = to_trajectory(json.at("ground_truth"));
  } catch (const std::exception& error) {
    throw InputError(fmt::format("{}: the metadata can't be read: {}", name, error.what()));
  }
  return recording;
}

}  // namespace evbench::native
