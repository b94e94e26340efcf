#pragma once

#include <string>
#include <vector>

#include "core/plugin/registry.hpp"
#include "eval/run_record.hpp"

namespace evbench {

/// What `evbench run` is told.
struct RunArguments {
  std::string config;
  std::vector<std::string> overrides;
  std::string out = "results";
  bool quiet = false;
  bool check = false;
  bool problem = false, tracks = false, watch = false;
  bool force = false;
  int jobs = 1;  ///< runs at a time; more than one: each in a process of its own
};

/// Does it: runs a config, writes the folders of its runs below `out`, prints the table. Returns the exit code:
/// kExitDone, or kExitFailed when a run failed. Throws InputError and Interrupted as the command does. `records` gets
/// its runs.
int run_config(const RunArguments& arguments, Plugins& plugins, std::vector<RunRecord>* records = nullptr);

}  // namespace evbench
