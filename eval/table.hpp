#pragma once

#include <span>
#include <string>
#include <vector>

#include "eval/names.hpp"
#include "eval/run_record.hpp"

namespace evbench {

enum class TableFormat { text, markdown, csv, latex };
inline constexpr NameList<4> kTableFormatNames = {"text", "markdown", "csv", "latex"};

struct TableOptions {
  TableFormat format = TableFormat::text;
  bool online = false;  ///< the scores of the estimates at the moment they were made, instead of the final ones
  /// Columns: paths into metrics.json ("realtime_factor", "times.waiting_s") or into its scores ("rpe.trans_m.median");
  /// empty: the default columns.
  std::vector<std::string> metrics = {};
};

/// A table of runs, a row each, in the order given. What tells them apart are columns: the label, the experiment and
/// the seed where they vary, settings in which runs of one label differ, named as in a config; the key, and the folder,
/// where these do not suffice. CSV has label, experiment, seed, key and folder always.
///
/// The protocol stands below (CSV: in columns), and whether the final or the online trajectory is scored; runs of
/// different protocols are marked with its number. LaTeX has fewer default columns, for a page. Pairs, coverage and
/// scale are columns, or, where `metrics` leaves them out, ranges below. The best value of a column, among runs of the
/// same experiment and protocol, is bold in Markdown and LaTeX and marked with * in text; runs that were lost or failed
/// do not compete. A value that a run does not have is "-" (CSV: empty). Why runs have no scores, or were lost, stands
/// below. Throws InputError when there is no run, when no run has a column's value at all, with the nearest known name,
/// and when no run has online scores but they are asked for.
std::string make_table(std::span<const RunRecord> runs, const TableOptions& options);

}  // namespace evbench
