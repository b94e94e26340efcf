#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "bench/pipeline/options.hpp"
#include "core/plugin/options.hpp"
#include "core/plugin/registry.hpp"
#include "core/support/json.hpp"

namespace evbench {

/// A plugin in a config: {"type": NAME, options...}.
struct PluginConfig {
  std::string type;
  Json options = Json::object();  ///< complete, checked
  std::string place;              ///< place in the config, for messages

  Json with_type() const;  ///< {"type": NAME, options...}
};

/// The computation of a run: one back-end on one front-end's tracks of one source.
struct Job {
  PluginConfig source, frontend, backend;
  std::uint64_t seed = 1;
  double trajectory_rate = 100.0;  ///< [Hz] at which final trajectories are sampled; 0: the back-end's own poses
  PipelineOptions pipeline;
  std::string folder;  ///< of the config: relative paths refer to it
};

/// SHA-256 of files, each read only once. Files must not change during its lifetime, one call of the program.
class Digests {
 public:
  /// The digest of a file's bytes; of a folder: of the names and digests of all files in and below it. Throws
  /// InputError if there is no such file or it can't be read.
  const std::string& of(const std::string& path);

 private:
  std::map<std::string, std::string> known_;
};

/// All that determines a job's trajectory. Name, label, evaluation protocol and paths of files are not part of it.
struct JobIdentity {
  /// The content of job.json: version of the pipeline, seed, rate, pipeline options, and of source, front-end and
  /// back-end the type, registered version, options without paths, the SHA-256 of every file that it reads, in order,
  /// and for plugins from outside that of their library. `sha256sum job.json` begins with the key's digits.
  std::string text;
  /// The name of the run's folder: the back-end's type and the first ten digits of the text's SHA-256.
  std::string key;
  std::vector<std::pair<std::string, std::string>> files;  ///< path and SHA-256 of the files read, each once
};

/// The digits of a key: the first ten of the SHA-256 of the job's text.
std::string digits_of_key(const std::string& text);

/// The files that a source reads.
struct SourceFiles {
  SourceFiles() = default;
  SourceFiles(const Source& source)  // NOLINT(google-explicit-constructor): convenient for callers with a source
      : files(source.files()), events(source.event_files()) {}

  std::vector<std::string> files, events;  ///< as Source::files() and event_files()
};

/// Computes the identity of a job. `source` is the job's. Throws InputError for a missing file.
JobIdentity identify(const Job& job, const SourceFiles& source, const Plugins& plugins, Digests& digests);

/// Makes the source of a job; the jobs of an experiment share it.
std::unique_ptr<Source> make_source(const Job& job, const Plugins& plugins);

}  // namespace evbench
