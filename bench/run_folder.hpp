#pragma once

#include <string>

#include "bench/runner.hpp"
#include "core/support/atomic_file.hpp"

namespace evbench {

/// Writes a run's folder `out`/EXPERIMENT/KEY and returns its path: config.json (resolved, complete), manifest.json
/// (program, host, seed, SHA-256 of inputs and tracks), final.tum, online.tum, map.ply, metrics.json, timing.csv (a
/// line per update), log.txt, status.json. Appears complete or not at all; an older run of the same key is replaced.
class RunFolder {
 public:
  /// Takes the folder: throws InputError when it can't be made or another run is writing to it, before any work.
  RunFolder(const std::string& out, const RunConfig& config);

  /// With `problem`, also problem.txt, the estimation problem that the run ended with, where the back-end has one.
  void write(const RunConfig& config, const RunResult& result, bool problem = false);
  const std::string& path() const { return path_; }

 private:
  std::string path_;
  AtomicFolder folder_;
};

/// The contents of metrics.json (eval/metrics.md).
Json metrics_json(const RunConfig& config, const RunResult& result);

}  // namespace evbench
