#pragma once

#include <string>
#include <vector>

#include "bench/sweep/local_executor.hpp"

namespace evbench {

/// A sweep's runs as lines of JSON, for processes that each do some of them, on this machine or others that share the
/// folder: {"key", "axes", "position", "config", "tracks", "events", "out", "timeout", "memory", "retry_failed"}, the
/// config complete, as in a run's config.json, and paths that are valid on all machines.
std::string format_manifest(const std::vector<PlannedRun>& runs, const ExecutorOptions& options);

/// A line of a manifest, as do_runs() takes it.
struct ManifestLine {
  PlannedRun run;
  ExecutorOptions options;
};

/// Reads the lines `first`, `first` + `stride`, ... (numbered from 1; stride 0: that one alone) and loads the libraries
/// that they name, by the policy. Throws InputError for a file that can't be read, a line that is no run, a `first`
/// beyond the last line, and files that have changed since the manifest was written: the key would be another one.
std::vector<ManifestLine> read_manifest(const std::string& path, std::size_t first, std::size_t stride,
                                        Plugins& plugins, const LibraryPolicy& policy = {});

}  // namespace evbench
