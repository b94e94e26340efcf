#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "bench/run_folder.hpp"
#include "core/io/file_content.hpp"
#include "core/io/sha256.hpp"
#include "core/plugin/write_options.hpp"
#include "core/support/json.hpp"
#include "eval/json_file.hpp"
#include "eval/score_run.hpp"

// Existing runs: finding, copying, relabelling, scoring again.

namespace evbench {
namespace fs = std::filesystem;
namespace {

bool is_complete(const std::string& folder, const JobIdentity& identity) {
  std::string ignored;
  return condition_of(folder, identity.key, ignored) == RunCondition::complete;
}

Json parse(const std::string& path) {
  const std::optional<std::string> text = file_content(path);
  if (!text) throw InputError(fmt::format("{}: can't be read", path));
  const Json json = try_parse_json(*text);
  if (!json.is_object()) throw InputError(fmt::format("{}: expected a JSON object", path));
  return json;
}

/// The damage of a run's files that is visible without reading the estimate; empty if there is none. Runs of older
/// versions have no list of sizes.
std::string damage_of(const std::string& folder, const std::string& key) {
  std::error_code error;
  if (!key.ends_with("-" + digits_of_key(file_content(folder + "/job.json").value_or("")))) {
    return fmt::format("{}/job.json: belongs to another job; expected that of {}", folder, key);
  }
  for (const char* name :
       {"config.json", "manifest.json", "final.tum", "causal.tum", "causal_poses.txt", "map.ply", "log.txt"}) {
    if (!is_file(folder + "/" + name)) return fmt::format("{}/{}: is missing", folder, name);
  }
  try {
    const Json manifest = parse(folder + "/manifest.json");
    if (!manifest.contains("sizes")) return "";
    for (const auto& [name, size] : manifest.at("sizes").items()) {
      const std::string path = folder + "/" + name;
      if (!is_file(path)) return path + ": is missing";
      if (size == fs::file_size(path, error)) continue;
      return fmt::format("{}: has {} bytes; expected {}", path, fs::file_size(path, error), dump_json(size));
    }
  } catch (const InputError& damage) {
    return damage.what();
  }
  return "";
}

/// Writes the run in `from` to `to` with this config and record, scored again by `options`.
RunRecord rewrite(const std::string& from, const std::string& to, const Json& config, RunRecord record,
                  const ScoreOptions& options, const std::string& log) {
  Json manifest = parse(from + "/manifest.json");
  manifest["config_sha256"] = sha256(json_file_text(config));
  score_run(from, options, record);
  const EmptyFolders made(fs::path(to).parent_path().string());
  AtomicFolder folder(to);
  for (const auto& entry : fs::directory_iterator(from)) {
    const std::string name = entry.path().filename().string();
    if (entry.is_regular_file()) folder.write(name, file_content(entry.path().string()).value_or(""));
  }
  folder.write("config.json", json_file_text(config));
  folder.write("manifest.json", json_file_text(manifest));
  folder.write("metrics.json", json_file_text(to_json(record)));
  if (!log.empty()) folder.write("log.txt", file_content(from + "/log.txt").value_or("") + log);
  folder.commit();
  record.folder = to;
  record.settings = settings_of(config);
  return record;
}

}  // namespace

RunCondition condition_of(const std::string& folder, const std::string& key, std::string& why) {
  std::error_code error;
  if (!fs::is_directory(folder, error)) return RunCondition::absent;
  why = damage_of(folder, key);
  if (!why.empty()) return RunCondition::damaged;
  try {
    const RunRecord record = read_record(folder);
    if (record.key == key && record.status) {
      if (record.status->complete) return RunCondition::complete;
      why = record.status->status.reason;
      return RunCondition::broken_off;
    }
    why = fmt::format("{}/metrics.json: has no status, or the key of another run", folder);
  } catch (const InputError& damage) {
    why = damage.what();
  }
  return RunCondition::damaged;
}

std::optional<std::string> find_complete_run(const std::string& out, const std::string& experiment,
                                             const JobIdentity& identity) {
  const std::string own = fmt::format("{}/{}/{}", out, experiment, identity.key);
  if (is_complete(own, identity)) return own;
  std::error_code error;
  std::vector<std::string> others;
  for (auto entry = fs::directory_iterator(out, error); entry != fs::directory_iterator(); entry.increment(error)) {
    const fs::path folder = entry->path() / identity.key;
    if (fs::is_directory(folder, error)) others.push_back(folder.string());
  }
  std::ranges::sort(others);
  const auto found = std::ranges::find_if(others, [&](const auto& folder) { return is_complete(folder, identity); });
  return found == others.end() ? std::nullopt : std::optional(*found);
}

RunRecord adopt_run(const std::string& from, const std::string& to, const RunConfig& config) {
  RunRecord record = read_record(from);
  const Json resolved = config.resolved();
  const std::optional<std::uint64_t> position = config.position ? config.position : record.position;
  const bool same_place = from == to && position == record.position;
  if (same_place && file_content(from + "/config.json") == json_file_text(resolved)) return record;
  std::string log;
  if (record.experiment != config.experiment || record.label != config.label) {
    log = fmt::format("not run again, but relabelled {}: {}\n", config.experiment, config.label);
  }
  record.experiment = config.experiment;
  record.label = config.label;
  record.position = position;
  return rewrite(from, to, resolved, std::move(record), config.evaluation, log);
}

ScoreOptions protocol_of_run(const std::string& folder, const std::vector<std::string>& overrides) {
  const std::string path = folder + "/config.json";
  const Json config = try_parse_json(file_content(path).value_or(""));
  if (!config.is_object() || !config.contains("evaluation")) {
    throw InputError(fmt::format("{}: can't be read, or has no \"evaluation\"; expected the config of a run", path));
  }
  return read_evaluation("", config["evaluation"], overrides, path);
}

void require_scores(const std::string& folder, const ScoreOptions& options) {
  const RunRecord before = read_record(folder);
  RunRecord record = before;
  score_run(folder, options, record);
  const bool lost = !before.final_scores.is_null() && record.final_scores.is_null();
  if (!lost || record.final_unscored == kNoGroundTruth) return;
  throw InputError(fmt::format("{}: has scores, but would have none by this protocol: {}; nothing was changed", folder,
                               record.final_unscored));
}

RunRecord score_again(const std::string& folder, const ScoreOptions& options) {
  Json config = parse(folder + "/config.json");
  config["evaluation"] = write_options(options);
  return rewrite(folder, folder, config, read_record(folder), options, "");
}

}  // namespace evbench
