#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bench/job.hpp"
#include "core/plugin/options.hpp"
#include "core/plugin/source.hpp"
#include "core/support/json.hpp"
#include "eval/scores.hpp"

namespace evbench {

/// One run: a job, what it is called, and how it is scored.
struct RunConfig {
  std::string experiment;
  std::string label;
  std::optional<std::size_t> position;  ///< in the list "backends", from 0
  Job job;
  ScoreOptions evaluation;
  std::vector<std::string> plugins;  ///< libraries, or folders of them, that the config names or its plugins come from

  /// All of it, complete with defaults: config.json of the run. It can be run again from anywhere: relative paths are
  /// taken from the config's folder.
  Json resolved() const;
};

/// A config file: one run ("backend") or a comparison of several back-ends on the identical observations ("backends").
struct Experiment {
  std::string name;
  std::string description;
  std::vector<RunConfig> runs;
  std::vector<std::string> remarks = {};  ///< on the file, for who wrote it: names that are old
};

/// A file of JSON, with comments if need be. Throws InputError when it can't be read or is none.
Json read_json(const std::string& path);

/// A config that is parsed once, and of which experiments are made with one set of overrides after another.
class ConfigFile {
 public:
  /// Parses a config file. Throws InputError when that can't be done.
  ConfigFile(const std::string& path, const Plugins& plugins);
  /// A config that stands in another file: `path` is its place, for messages and for relative paths.
  ConfigFile(std::string path, Json config, const Plugins& plugins);

  /// As read_experiment() gives it. `origin` says in messages where the overrides come from.
  Experiment experiment(const std::vector<std::string>& overrides, const std::string& origin = "--set") const;

 private:
  std::string path_;
  Json config_, schema_;
  const Plugins& plugins_;
};

/// Reads a config file. `overrides` are "key=value" with the key a path of names and list positions
/// ("backends.0.batch_duration=0.1") and the value JSON, or text where it is not JSON.
/// Throws InputError with the place for anything that is not as expected; nothing has been run or written then.
Experiment read_experiment(const std::string& path, const std::vector<std::string>& overrides, const Plugins& plugins);

/// The libraries that a config's key "plugins" names, to be loaded before it is read: paths taken from its folder,
/// environment variables replaced.
std::vector<std::string> read_plugin_paths(const std::string& path, const std::vector<std::string>& overrides);

/// The parts of a config whose plugins are not known, as "frontend mine"; overrides as in read_experiment().
std::vector<std::string> unknown_plugins(const std::string& path, const std::vector<std::string>& overrides,
                                         const Plugins& plugins);

/// The protocol of a config file or, where `path` is empty, `otherwise`, with overrides "evaluation.KEY=VALUE". `place`
/// stands for the config in messages when there is no file.
ScoreOptions read_evaluation(const std::string& path, const Json& otherwise, const std::vector<std::string>& overrides,
                             const std::string& place);

/// A config file's source alone; nothing else of the file is looked at but its seed.
std::unique_ptr<Source> read_source(const std::string& path, const Plugins& plugins,
                                    const std::vector<std::string>& overrides = {});

/// A config file's top level: for people, and as a JSON Schema with all known plugins' options, for editors.
std::string describe_experiment();
Json experiment_schema(const Plugins& plugins);

}  // namespace evbench
