#pragma once

#include <string>
#include <vector>

#include "eval/run_numbers.hpp"
#include "eval/table.hpp"

namespace evbench {

/// The distinct protocols of runs, and the index of each run's protocol; -1 for a run without scores.
struct Protocols {
  std::vector<std::string> texts;
  std::vector<int> of_run;
};
Protocols collect_protocols(const std::vector<RunNumbers>& runs);

/// The notes below a table of runs: the scored trajectory, the protocols, pairs, coverage and scale if they are not
/// columns, the common time, and, except for LaTeX, the failures of runs. `names`: of the runs.
std::vector<std::string> table_notes(const std::vector<RunNumbers>& runs, const std::vector<std::string>& names,
                                     const std::vector<Metric>& metrics, const Protocols& protocols,
                                     const TableOptions& options);

/// The status for text tables: "ok", "ok, covers 73 % from 1.20 s", "lost at 3.25 s", "timeout after 60 s", "not run".
std::string status_text(const RunNumbers& numbers);
/// The status for CSV: "ok", "degraded", "lost", "failed", "damaged" or "not run"; and the reason, empty if it is ok.
std::string status_word(const RunRecord& run);
std::string status_reason(const RunRecord& run);

}  // namespace evbench
