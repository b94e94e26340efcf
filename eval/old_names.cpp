#include "eval/old_names.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <utility>

#include "core/support/json.hpp"

namespace evbench {
namespace {

struct OldName {
  const char* part;    ///< of the config: backend, pipeline
  const char* type;    ///< of the plugin; empty: any
  const char* before;  ///< a key, or GROUP.KEY
  const char* now;     ///< likewise
};

constexpr OldName kKeys[] = {
    {"backend", "bundle_adjustment", "frame_duration", "batch_duration"},
    {"backend", "bundle_adjustment", "frame_observations", "batch_observations"},
    {"backend", "bundle_adjustment", "frame_motion", "batch_motion"},
    {"backend", "bundle_adjustment", "shortest_frame", "min_batch_duration"},
    {"backend", "bundle_adjustment", "min_track_frames", "min_track_batches"},
    {"backend", "gp_map", "map.outlier_threshold", "outliers.threshold"},
    {"backend", "gp_map", "map.returns", "reassociation.returns"},
    {"backend", "gp_map", "map.leverage", "leverage.nearness"},
    {"backend", "gp_map", "map.search_interval", "search.interval"},
    {"pipeline", "", "still_after", "stationary_after"},
};

constexpr std::pair<const char*, const char*> kFiles[] = {
    {"causal.tum", "online.tum"},
    {"causal_poses.txt", "told.txt"},
};

bool rename(Json& object, const char* before, const char* now) {
  if (!object.is_object() || !object.contains(before) || object.contains(now)) return false;
  object[now] = std::move(object[before]);
  object.erase(before);
  return true;
}

/// A pointer to KEY or GROUP.KEY.
Json::json_pointer pointer_to(std::string path) {
  std::ranges::replace(path, '.', '/');
  return Json::json_pointer("/" + path);
}

bool rename_path(Json& part, const char* before, const char* now) {
  const Json::json_pointer old_place = pointer_to(before), place = pointer_to(now), group = place.parent_pointer();
  if (!part.contains(old_place) || part.contains(place)) return false;
  if (part.contains(group) && !part[group].is_object()) return false;
  Json value = part[old_place];
  part[place] = std::move(value);
  Json& left = part[old_place.parent_pointer()];
  left.erase(old_place.back());
  if (left.empty() && &left != &part) part.erase(old_place.parent_pointer().back());
  return true;
}

void rename_keys(Json& part, const char* name, std::vector<std::string>& remarks) {
  if (!part.is_object()) return;
  const Json type = part.value("type", Json());
  for (const OldName& key : kKeys) {
    if (std::string(key.part) != name || (*key.type != '\0' && type != key.type)) continue;
    if (rename_path(part, key.before, key.now)) {
      remarks.push_back(fmt::format("{}.{} is called {} now; the old name is read until the next version", name,
                                    key.before, key.now));
    }
  }
  Json* const learn = part.contains("learn") ? &part["learn"] : nullptr;
  if (type == "gp_map" && learn != nullptr && learn->is_object() && learn->value("prior", Json()) == "hindsight") {
    (*learn)["prior"] = "smoothed";
    remarks.push_back(
        fmt::format("{}.learn.prior: \"hindsight\" is called \"smoothed\" now; the old name is read until "
                    "the next version",
                    name));
  }
}

}  // namespace

std::vector<std::string> rename_old_keys(Json& config) {
  std::vector<std::string> remarks;
  if (!config.is_object()) return remarks;
  for (const char* part : {"backend", "pipeline"}) {
    if (config.contains(part)) rename_keys(config[part], part, remarks);
  }
  if (config.contains("backends") && config["backends"].is_array()) {
    for (Json& backend : config["backends"]) rename_keys(backend, "backend", remarks);
  }
  return remarks;
}

void rename_old_metrics(Json& metrics) {
  if (!metrics.is_object()) return;
  rename(metrics, "online", "causal");
  rename(metrics, "online_unscored", "causal_unscored");
  const auto status = metrics.find("status");
  if (status == metrics.end()) return;
  rename(*status, "still", "stationary");
  rename(*status, "pieces", "segments");
  rename(*status, "scored_piece", "scored_segment");
}

std::string present_metric(const std::string& name) {
  constexpr const char* kBefore = "online.";
  return name.starts_with(kBefore) ? "causal." + name.substr(std::char_traits<char>::length(kBefore)) : name;
}

std::string file_of_run(const std::string& folder, const std::string& name) {
  const std::string path = folder + "/" + name;
  std::error_code ignored;
  for (const auto& [now, before] : kFiles) {
    const std::string older = folder + "/" + before;
    if (name == now && !std::filesystem::exists(path, ignored) && std::filesystem::exists(older, ignored)) return older;
  }
  return path;
}

}  // namespace evbench
