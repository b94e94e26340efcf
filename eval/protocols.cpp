#include "eval/protocols.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "core/support/error.hpp"
#include "core/support/nearest.hpp"

namespace evbench {
namespace {

constexpr std::array kOfData = {"protocol", "time_offset", "time_range", "min_pairs", "latency"};

Json written(ScoreOptions options) {
  OptionSet set;
  options.declare(set);
  return set.write();
}

/// The options that belong to a protocol.
Json settings_of(const ScoreOptions& options) {
  Json json = written(options);
  for (const char* key : kOfData) json.erase(key);
  return json;
}

const NamedProtocol* find(const std::string& name) {
  const auto& all = named_protocols();
  const auto found = std::ranges::find(all, name, &NamedProtocol::name);
  return found == all.end() ? nullptr : &*found;
}

}  // namespace

const std::vector<NamedProtocol>& named_protocols() {
  static const std::vector<NamedProtocol> protocols = {
      {"evo",
       "evo_ape and evo_rpe without options",
       "No alignment; nearest ground truth within 0.01 s; relative errors from each pose to the next.",
       "ate.trans_m.rmse, rpe.trans_m.rmse",
       {.alignment = "none", .rpe_delta = 1.0, .rpe_unit = "frames", .rpe_pairing = "consecutive"}},
      {"tum",
       "TUM RGB-D benchmark (Sturm et al. 2012): evaluate_ate.py, evaluate_rpe.py with --fixed_delta",
       "SE(3) on all poses; nearest ground truth within 0.02 s; relative errors over 1 s from every pose. Without "
       "--fixed_delta evaluate_rpe.py draws 10,000 random pairs, and its numbers differ.",
       "ate.trans_m.rmse, rpe.trans_m.rmse",
       {.alignment = "se3", .tolerance = 0.02, .rpe_delta = 1.0}},
      {"devo",
       "DEVO (Klenk et al. 2024)",
       "Sim(3) on all poses; nearest ground truth within 1 s; mean position error over the path of the ground truth. "
       "Published: the median of 5 runs (evbench table --over seed).",
       "mpe_percent, ate.trans_m.rmse",
       {.alignment = "sim3", .tolerance = 1.0}},
      {"deio",
       "DEIO (Guan et al. 2024)",
       "Sim(3) on the first 1,000 compared poses; nearest ground truth within 1 s; mean position error over the path "
       "of "
       "the ground truth.",
       "mpe_percent, ate.trans_m.rmse",
       {.alignment = "sim3", .align_first = 1000, .tolerance = 1.0}},
      {"hku_5s",
       "Mono-EIO, PL-EVIO (Guan et al. 2022, 2023)",
       "SE(3) on the first 5 s of the compared poses; nearest ground truth within 0.01 s; mean position error over the "
       "path.",
       "mpe_percent",
       {.alignment = "se3", .align_seconds = {0.0, 5.0}}},
      {"eklt_vio",
       "Ultimate SLAM, HASTE-VIO, EKLT-VIO (Mahlknecht et al. 2022)",
       "Position and yaw on seconds 3 to 8 of the compared poses, z being the vertical; nearest ground truth within "
       "0.02 s; mean position "
       "error over the path, mean yaw error in degrees a metre.",
       "mpe_percent, mye_deg_per_m",
       {.alignment = "yaw", .align_seconds = {3.0, 8.0}, .tolerance = 0.02}},
      {"evslam",
       "EvSLAM benchmark (Zhong et al. 2026)",
       "SE(3) on all poses; nearest ground truth within 0.001 s; area under the curve of relative velocity errors. "
       "Export poses and velocities at its times: evbench export RUN --at times.txt --velocity.",
       "ate.trans_m.rmse, velocity.rve.auc",
       {.alignment = "se3", .tolerance = 0.001}},
      {"esvo",
       "ESVO, ESVO2 (Zhou et al. 2021, Niu et al. 2025)",
       "SE(3) on all poses; nearest ground truth within 0.02 s; relative errors over 1 s from every pose: cm/s and "
       "deg/s.",
       "rpe.trans_m.rmse, rpe.rot_deg.rmse, ate.trans_m.rmse",
       {.alignment = "se3", .tolerance = 0.02, .rpe_delta = 1.0}},
      {"rpg",
       "rpg_trajectory_evaluation (Zhang and Scaramuzza 2018), monocular",
       "Sim(3) on all poses; nearest ground truth within 0.02 s; errors over sub-trajectories of 10 to 50 % of the "
       "path.",
       "ate.trans_m.rmse, segments.trans_percent.mean, segments.rot_deg_per_m.mean",
       {.alignment = "sim3", .tolerance = 0.02, .segments = "rpg"}},
      {"kitti",
       "KITTI odometry benchmark (Geiger et al. 2012)",
       "No alignment; errors over sub-trajectories of 100 to 800 m. Poses are compared frame by frame: here the "
       "nearest "
       "within 0.01 s.",
       "segments.trans_percent.mean, segments.rot_deg_per_m.mean",
       {.alignment = "none", .segments = "kitti"}},
  };
  return protocols;
}

std::vector<std::string> protocol_choices() {
  std::vector<std::string> names = {"none"};
  for (const NamedProtocol& protocol : named_protocols()) names.emplace_back(protocol.name);
  return names;
}

void forget_protocol(Json& evaluation) {
  if (!evaluation.is_object()) return;
  const Json settings = settings_of({});
  for (const auto& [key, value] : settings.items()) evaluation.erase(key);
}

void fill_in_protocol(Json& evaluation) {
  if (!evaluation.is_object() || !evaluation.contains("protocol") || !evaluation["protocol"].is_string()) return;
  const NamedProtocol* const protocol = find(evaluation["protocol"].get<std::string>());
  if (protocol == nullptr) return;
  const Json settings = settings_of(protocol->options);
  constexpr std::array kAligned = {"align_first", "align_range", "align_seconds"};
  const auto given = [&](const char* key) { return evaluation.contains(key); };
  const bool says_where = std::ranges::any_of(kAligned, given);  // one of them is enough
  for (const auto& [key, value] : settings.items()) {
    const bool where = std::ranges::find(kAligned, key) != kAligned.end();
    if (!evaluation.contains(key) && !(where && says_where)) evaluation[key] = value;
  }
}

ScoreOptions options_by_protocol(const std::string& name, const ScoreOptions& data) {
  const NamedProtocol* const protocol = find(name);
  if (protocol == nullptr) {
    throw InputError(fmt::format("there is no protocol \"{}\"{}; see evbench list protocols", name,
                                 suggestion(name, protocol_choices())));
  }
  ScoreOptions options = protocol->options;
  options.protocol = name;
  options.time_offset = data.time_offset;
  options.time_range = data.time_range;
  options.min_pairs = data.min_pairs;
  options.latency = data.latency;
  return options;
}

Json protocol_json(const ScoreOptions& options) {
  const NamedProtocol* const protocol = find(options.protocol);
  if (protocol == nullptr) return nullptr;
  const Json own = settings_of(options), defined = settings_of(protocol->options);
  Json custom = Json::array();
  for (const auto& [key, value] : own.items()) {
    if (defined.at(key) != value) custom.push_back(key);
  }
  return {{"name", options.protocol}, {"custom", std::move(custom)}};
}

std::string describe_protocols() {
  std::string text;
  for (const NamedProtocol& protocol : named_protocols()) {
    text +=
        fmt::format("{}: {}\n    {}\n    {}\n", protocol.name, protocol.source, protocol.definition, protocol.metrics);
  }
  return text;
}

}  // namespace evbench
