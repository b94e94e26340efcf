#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bench/experiment.hpp"
#include "core/plugin/backend.hpp"
#include "core/plugin/source.hpp"

namespace evbench {

/// What a run ended with.
struct RunResult {
  Status status;
  PoseTrajectory final_trajectory;   ///< sampled at the config's trajectory rate
  PoseTrajectory online_trajectory;  ///< causal, the back-end's own times
  std::vector<Landmark> map;
  std::optional<Problem> problem;  ///< that the back-end ended with, where it has one
  std::vector<UpdateRecord> updates;
  std::optional<Scores> final_scores, online_scores;
  std::string final_unscored, online_unscored;  ///< why there are no scores
  double runtime_s = 0.0;                       ///< wall time in the back-end
  double data_s = 0.0;                          ///< time of the sequence that it was given
  double peak_rss_mib = 0.0;                    ///< of the process during the run, source and tracks included
  std::string tracks_sha256;                    ///< of all observations: equal for runs that can be compared
  std::size_t observations = 0;
  std::vector<std::string> files;  ///< that were read
  std::vector<std::string> log;
};

/// Called now and then with the sequence time that has been reached and the sequence's end [s].
using Progress = std::function<void(double t, double end)>;

/// Makes the source of an experiment; its runs share it.
std::unique_ptr<Source> make_source(const RunConfig& config);

/// Source → front-end → back-end → scores. Throws InputError for bad input only.
RunResult run(const RunConfig& config, const Source& source, const Progress& progress);

}  // namespace evbench
