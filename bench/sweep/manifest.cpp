#include "bench/sweep/manifest.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>

#include "bench/experiment.hpp"
#include "core/io/path.hpp"
#include "core/support/error.hpp"
#include "core/support/json.hpp"

namespace evbench {
namespace {

ManifestLine read_line(const std::string& text, const std::string& place, Plugins& plugins, const LibraryPolicy& policy,
                       Digests& digests) {
  const Json json = try_parse_json(text);
  ManifestLine line;
  try {
    line.options.out = json.at("out").get<std::string>();
    line.options.limits.seconds = json.at("timeout").get<double>();
    line.options.limits.memory_mib = json.at("memory").get<double>();
    line.options.retry_failed = json.at("retry_failed").get<bool>();
    std::vector<std::string> libraries;
    for (const Json& library : json.at("config").at("plugins")) {
      libraries.push_back(resolve_path(library.get<std::string>(), "."));
    }
    load_named_plugins(plugins, libraries, place, policy);
    for (const auto& [axis, value] : json.at("axes").items())
      line.run.axes.emplace_back(axis, value.get<std::string>());
    line.run.config = ConfigFile(place, json.at("config"), plugins).experiment({}).runs.at(0);
    if (!json.at("position").is_null()) line.run.config.position = json.at("position").get<std::size_t>();
    line.run.tracks = json.at("tracks").get<std::string>();
    line.run.events = json.at("events").get<std::string>();
    const Job& job = line.run.config.job;
    line.run.identity = identify(job, *make_source(job, plugins), plugins, digests);
    const auto key = json.at("key").get<std::string>();
    if (line.run.identity.key != key) {
      throw InputError(
          fmt::format("{}: what the run reads has changed since the manifest was written: its key was {} "
                      "and is {}; start the sweep again",
                      place, key, line.run.identity.key));
    }
  } catch (const Json::exception&) {
    throw InputError(fmt::format("{}: is no run of a sweep's manifest", place));
  }
  return line;
}

/// Lines that other processes do may need the same events. Events that no other line needs are not kept.
void share_events(std::vector<ManifestLine>& lines, const std::vector<std::string>& texts) {
  if (std::ranges::all_of(lines, [](const ManifestLine& line) { return line.run.events.empty(); })) return;
  std::map<std::string, std::vector<std::string>> keys;  // by the name of the events
  for (const std::string& text : texts) {
    const Json json = try_parse_json(text);
    if (json.is_object()) keys[json.value("events", "")].push_back(json.value("key", ""));
  }
  for (auto& [run, options] : lines) {
    if (run.events.empty()) continue;
    run.events_for = keys[run.events];
    if (run.events_for.size() < 2) run.events.clear();
  }
}

}  // namespace

std::string format_manifest(const std::vector<PlannedRun>& runs, const ExecutorOptions& options) {
  std::string text;
  for (const PlannedRun& run : runs) {
    Json axes = Json::object();
    for (const auto& [axis, value] : run.axes) axes[axis] = value;
    const Json line = {{"key", run.identity.key},
                       {"axes", axes},
                       {"position", run.config.position ? Json(*run.config.position) : Json()},
                       {"config", run.config.resolved()},
                       {"tracks", run.tracks},
                       {"events", run.events},
                       {"out", std::filesystem::absolute(options.out).string()},
                       {"timeout", options.limits.seconds},
                       {"memory", options.limits.memory_mib},
                       {"retry_failed", options.retry_failed}};
    text += dump_json(line) + "\n";
  }
  return text;
}

std::vector<ManifestLine> read_manifest(const std::string& path, std::size_t first, std::size_t stride,
                                        Plugins& plugins, const LibraryPolicy& policy) {
  std::ifstream file(path);
  if (!file) throw InputError(fmt::format("{}: can't be read; expected the manifest of a sweep", path));
  Digests digests;
  std::vector<ManifestLine> lines;
  std::vector<std::string> texts;
  for (std::string text; std::getline(file, text);) {
    texts.push_back(text);
    const std::size_t number = texts.size();
    const bool wanted = stride == 0 ? number == first : number >= first && (number - first) % stride == 0;
    if (!wanted) continue;
    lines.push_back(read_line(text, fmt::format("{}:{}", path, number), plugins, policy, digests));
  }
  if (lines.empty()) throw InputError(fmt::format("{}: has {} lines; expected a line {}", path, texts.size(), first));
  share_events(lines, texts);
  return lines;
}

}  // namespace evbench
