#pragma once

#include <string>
#include <vector>

namespace evbench {

/// The list of the experiments whose results are in the repository, from its root.
inline constexpr const char* kReferenceExperiments = "results/reference/experiments.json";

/// An experiment of the reference results: shell commands, called in the root of the repository, that make
/// results/NAME.
struct ReferenceExperiment {
  std::string name;
  std::vector<std::string> commands;
  std::vector<std::string> needs;  ///< environment variables that must be set
};

/// All experiments, in the order of the file. Throws InputError for a file that is not there or damaged.
std::vector<ReferenceExperiment> read_reference_experiments(const std::string& path);

/// Runs the commands, "evbench" in them being this program, with `jobs` runs at a time (0: as many as sweeps do).
/// Returns the worst exit code: a command that ends with kExitFailed, because runs failed, does not keep the others
/// from running. Throws Interrupted where a command was asked to end, OutputError where it can't write, and InputError
/// where a variable is not set or a command ends in another way.
int run_reference_experiment(const ReferenceExperiment& experiment, int jobs);

}  // namespace evbench
