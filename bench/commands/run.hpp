#pragma once

#include <string>
#include <vector>

#include "core/plugin/registry.hpp"
#include "eval/run_record.hpp"

namespace evbench {

/// Arguments of `evbench run`.
struct RunArguments {
  std::string config;
  std::vector<std::string> overrides;
  std::string out = "results";
  bool quiet = false;
  bool check = false;
  bool problem = false, tracks = false, watch = false;
  bool force = false;
  bool report = false;
  int jobs = 1;  ///< runs at a time; more than one: each in a process of its own
};

/// Runs a config, writes the folders of its runs below `out` and prints the table. Returns the exit code: kExitDone, or
/// kExitFailed when a run failed. Throws InputError, OutputError or Interrupted. Appends the runs to `records`.
int run_config(const RunArguments& arguments, Plugins& plugins, std::vector<RunRecord>* records = nullptr);

}  // namespace evbench
