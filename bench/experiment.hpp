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

/// One run of a config: the job, its label, and its evaluation protocol.
struct RunConfig {
  std::string experiment;
  std::string label;
  std::optional<std::size_t> position;  ///< in the list "backends", from 0
  Job job;
  ScoreOptions evaluation;
  std::vector<std::string> plugins;  ///< libraries, or folders of them, named by the config or used by its plugins

  /// The complete config with defaults: config.json of the run. It can be run from any folder: relative paths are
  /// resolved from the original config's folder.
  Json resolved() const;
};

/// A config file: one run ("backend") or a comparison of several back-ends ("backends"), which get identical tracks
/// unless the front-end uses their feedback.
struct Experiment {
  std::string name;
  std::string description;
  std::vector<RunConfig> runs;
  std::vector<std::string> remarks = {};  ///< on the file: old names in use
};

/// Reads a JSON file, which may have comments. Throws InputError if it can't be read or is not JSON.
Json read_json(const std::string& path);

/// A config that is parsed once, to make experiments with different overrides.
class ConfigFile {
 public:
  /// Parses a config file. Throws InputError if that fails.
  ConfigFile(const std::string& path, const Plugins& plugins);
  /// A config inside another file: `path` is that file, for messages and for relative paths.
  ConfigFile(std::string path, Json config, const Plugins& plugins);

  /// As read_experiment(). `origin`: of the overrides, in messages.
  Experiment experiment(const std::vector<std::string>& overrides, const std::string& origin = "--set") const;

 private:
  std::string path_;
  Json config_, schema_;
  const Plugins& plugins_;
};

/// Reads a config file. `overrides` are "key=value" with the key a path of names and list positions
/// ("backends.0.batch_duration=0.1") and the value JSON, or text where it is not JSON.
/// Throws InputError with the place for anything unexpected, before anything is run or written.
Experiment read_experiment(const std::string& path, const std::vector<std::string>& overrides, const Plugins& plugins);

/// The libraries in a config's key "plugins", which must be loaded before the config is read. Relative paths are
/// resolved from its folder, environment variables replaced.
std::vector<std::string> read_plugin_paths(const std::string& path, const std::vector<std::string>& overrides);

/// The parts of a config with unknown plugins, as "frontend mine"; overrides as in read_experiment().
std::vector<std::string> unknown_plugins(const std::string& path, const std::vector<std::string>& overrides,
                                         const Plugins& plugins);

/// The evaluation protocol of a config file or, if `path` is empty, `otherwise`, with overrides "evaluation.KEY=VALUE".
/// `place` names the config in messages if there is no file.
ScoreOptions read_evaluation(const std::string& path, const Json& otherwise, const std::vector<std::string>& overrides,
                             const std::string& place);

/// Makes the source of a config file. Reads only its keys "source" and "seed".
std::unique_ptr<Source> read_source(const std::string& path, const Plugins& plugins,
                                    const std::vector<std::string>& overrides = {});

/// Documents the top level of a config file: as text, and as a JSON Schema with the options of all known plugins.
std::string describe_experiment();
Json experiment_schema(const Plugins& plugins);

}  // namespace evbench
