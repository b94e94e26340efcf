#pragma once

#include <string>
#include <vector>

#include "eval/run_numbers.hpp"
#include "eval/table.hpp"

namespace evbench {

/// The distinct protocols of runs, and each run's number among them; -1 for a run without scores.
struct Protocols {
  std::vector<std::string> texts;
  std::vector<int> of_run;
};
Protocols collect_protocols(const std::vector<RunNumbers>& runs);

/// What is to be said below a table of runs, in sentences: which trajectory, the protocols, pairs, coverage and scale
/// as far as they are no columns, the common time, and, unless `options` are of LaTeX, what went wrong with which run.
/// `names`: what each run is called.
std::vector<std::string> table_notes(const std::vector<RunNumbers>& runs, const std::vector<std::string>& names,
                                     const std::vector<Metric>& metrics, const Protocols& protocols,
                                     const TableOptions& options);

/// For people: "ok", "ok, covers 73 % from 1.20 s", "lost at 3.25 s", "timeout after 60 s", "not run".
std::string status_text(const RunNumbers& numbers);
/// For programs: "ok", "lost", "failed", "damaged", "not run", and why, which is empty where all is well.
std::string status_word(const RunRecord& run);
std::string status_reason(const RunRecord& run);

}  // namespace evbench
