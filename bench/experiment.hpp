#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "core/plugin/options.hpp"
#include "core/plugin/source.hpp"
#include "eval/scores.hpp"

namespace evbench {

/// A plugin as a config names it: {"type": NAME, options...}.
struct PluginConfig {
  std::string type;
  Json options = Json::object();  ///< complete, checked
  std::string place;              ///< where it stands, for messages
};

/// One run: one back-end on one front-end's tracks of one source.
struct RunConfig {
  std::string experiment;
  std::string label;
  std::uint64_t seed = 1;
  std::string folder;  ///< of the config: relative paths refer to it
  PluginConfig source, frontend, backend;
  double trajectory_rate = 100.0;
  ScoreOptions evaluation;

  /// Everything that determines the result, complete with defaults: config.json of the run. It can be run again from
  /// anywhere: relative paths are taken from the config's folder.
  Json resolved() const;
  /// The name of the run's folder: a readable part and a hash of resolved().
  std::string key() const;
};

/// A config file: one run ("backend") or a comparison of several back-ends on the identical observations ("backends").
struct Experiment {
  std::string name;
  std::string description;
  std::vector<RunConfig> runs;
};

/// Reads a config file. `overrides` are "key=value" with the key a path of names and list positions
/// ("backends.0.frame_duration=0.1") and the value JSON, or text where it is not JSON.
/// Throws InputError with the place for anything that is not as expected; nothing has been run or written then.
Experiment read_experiment(const std::string& path, const std::vector<std::string>& overrides);

/// A config file's source alone; nothing else of the file is looked at but its seed.
std::unique_ptr<Source> read_source(const std::string& path);

/// A config file's top level: for people, and as a JSON Schema with all registered plugins' options, for editors.
std::string describe_experiment();
Json experiment_schema();

}  // namespace evbench
