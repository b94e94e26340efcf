#pragma once

#include <span>
#include <string>
#include <vector>

#include "eval/names.hpp"
#include "eval/run_record.hpp"

namespace evbench {

enum class TableFormat { text, markdown, csv, latex, long_csv };
inline constexpr NameList<5> kTableFormatNames = {"text", "markdown", "csv", "latex", "long"};

/// How a table is written down.
struct TableLayout {
  /// Of text, in characters: columns that do not fit are left out, the least important first, and named below; 0: all.
  std::size_t width = 0;
  bool body = false;  ///< of LaTeX: the tabular alone, what is said about it in comments
};

struct TableOptions {
  TableFormat format = TableFormat::text;
  bool causal = false;  ///< the scores of the estimates at the moment they were made, instead of the final ones
  /// Columns: paths into metrics.json ("realtime_factor", "times.waiting_s") or into its scores ("rpe.trans_m.median");
  /// empty: the default columns. "key", "folder" and "status" are columns, too, of a table with a row a run.
  std::vector<std::string> metrics = {};
  /// What rows are summarised over, e.g. {"seed"}: names of run_columns(). Empty: a row a run.
  std::vector<std::string> over = {};
  TableLayout layout = {};
  bool folders = false;  ///< a column with the folder of each run, where a row is a run
};

/// A table of runs, a row each, in the order given. What tells them apart are columns: the label, the experiment and
/// the seed where they vary, settings in which runs of one label differ, named as in a config; the key, and the folder,
/// where these do not suffice. CSV has label, experiment, seed, key and folder always.
///
/// The protocol stands below (CSV: in columns; LaTeX: in the caption), and whether the final or the causal trajectory
/// is scored; runs of different protocols are marked with its number. LaTeX has fewer default columns, with shorter
/// headers, for a column of a page; it has no folders, of paths that stand for labels what they differ in, and no
/// sentence about what went wrong with a run, but its status as a column.
///
/// Beside the status of a run stands what is missing of its trajectory: "ok, covers 73 %" where that is less than 90 %
/// of the time, "ok, from 1.20 s" where it begins more than a second after the sequence.
///
/// Pairs, coverage and scale are columns, or, where `metrics` leaves them out, ranges below. The best value of a
/// column, among runs of the same experiment, sequence (seed included) and protocol, is bold in Markdown and LaTeX and
/// marked with * in text, which is explained below; runs that were lost or failed do not compete. A value that a run
/// does not have is "-" (CSV: empty). Why runs have no scores, or were lost, stands below.
///
/// With `over`, runs that differ in nothing else are a row: median and quartiles of each number, and how many of them
/// succeeded, that is, have scores and were neither lost nor failed. Those that did not count as worse than all others
/// in every number of which lower or higher is better ("fails"). Bold is what significantly differs from all other rows
/// of the same experiment and protocol: Wilcoxon's test on pairs of the same data, corrected by Holm for the number of
/// rows, p < 0.05 (paired_comparison.hpp). CSV has columns KEY.lower, KEY.median and KEY.upper, infinite where that is
/// of a run that did not succeed.
///
/// The format "long" is a CSV with a line a run and metric, of all known ones where none are asked for, and what tells
/// runs apart as columns: what pandas and R read at once.
///
/// Throws InputError when there is no run, when no run has a column's value at all, with the nearest known name, when
/// no run has causal scores but they are asked for, and with `over` when runs do not differ in what it names or when
/// two of a row have the same seed (or whatever `over` names) but are not the same job.
std::string make_table(std::span<const RunRecord> runs, const TableOptions& options);

/// A line for each number that any of the runs has: its key, as TableOptions::metrics takes it, and its header.
std::string list_metrics(std::span<const RunRecord> runs);

/// Does such a table of so many runs show scores over common time (bench/common_time.hpp)? They take long: the runs'
/// trajectories are scored again. So tables of more than kCommonTimeRuns runs have them only where they are asked for.
bool shows_common_time(const TableOptions& options, std::size_t runs);
/// Is any of these metrics of common time?
bool any_of_common_time(const std::vector<std::string>& metrics);
inline constexpr std::size_t kCommonTimeRuns = 500;

}  // namespace evbench
