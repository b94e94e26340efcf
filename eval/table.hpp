#pragma once

#include <span>
#include <string>
#include <vector>

#include "eval/names.hpp"
#include "eval/run_record.hpp"

namespace evbench {

enum class TableFormat { text, markdown, csv, latex, long_csv };
inline constexpr NameList<5> kTableFormatNames = {"text", "markdown", "csv", "latex", "long"};

/// Layout of a table.
struct TableLayout {
  /// Width of text [characters]: columns that do not fit are left out, the least important first, and listed in a note;
  /// 0: all columns.
  std::size_t width = 0;
  bool body = false;  ///< LaTeX: only the tabular, with the notes as comments
};

struct TableOptions {
  TableFormat format = TableFormat::text;
  bool causal = false;  ///< the scores of the causal trajectory, instead of the final one
  /// Columns: paths into metrics.json ("realtime_factor", "times.waiting_s") or into its scores ("rpe.trans_m.median");
  /// empty: the default columns. A table with a row per run also has the columns "key", "folder" and "status".
  std::vector<std::string> metrics = {};
  /// Columns over which rows are summarised, e.g. {"seed"}: names of run_columns(). Empty: a row per run.
  std::vector<std::string> over = {};
  /// The other way round: rows are summarised over all columns that vary, but the label and these.
  std::vector<std::string> by = {};
  /// Summaries also count the runs that follow the ground truth: those with an ATE of at most so many percent of the
  /// path, whose final trajectory covers at least 90 % of the time, and that are neither lost nor failed; 0: they do
  /// not. Implied by `by`.
  double success = 0.0;
  TableLayout layout = {};
  bool folders = false;  ///< a column with the folder of each run, in a table with a row per run
};

/// A table of runs, a row each, in the order given. These columns distinguish the runs: the label, the experiment and
/// the seed if they vary, settings in which runs of one label differ, named as in a config; the key, and the folder, if
/// these do not suffice. CSV always has label, experiment, seed, key and folder.
///
/// Notes below the table (CSV: columns; LaTeX: the caption) give the protocol, and whether the final or the causal
/// trajectory is scored; runs of different protocols are marked with its number. LaTeX has fewer default columns, with
/// shorter headers, for a column of a page. It has no folders, shortens paths that serve as labels to the parts in
/// which they differ, and has a status column instead of notes about failures.
///
/// The status of a run includes what is missing of its trajectory: "ok, covers 73 %" if it is less than 90 % of the
/// time, "ok, from 1.20 s" if it begins more than a second after the sequence.
///
/// Pairs, coverage and scale are columns, or, if `metrics` does not have them, ranges in a note. The best value of a
/// column, among runs of the same experiment, sequence (seed included) and protocol, is bold in Markdown and LaTeX and
/// marked with * in text, which a note explains; lost and failed runs do not compete. A missing value is "-" (CSV:
/// empty). Notes give the reasons why runs have no scores, or were lost.
///
/// With `over`, runs that differ in nothing else are one row: median and quartiles of each number, and the number of
/// successful runs, which have scores and are neither lost nor failed. The others count as worse than all others in
/// every number of which lower or higher is better ("fails"). Bold values differ significantly from all other rows of
/// the same experiment and protocol: Wilcoxon's test on pairs of the same data, corrected by Holm for the number of
/// rows, p < 0.05 (paired_comparison.hpp). CSV has columns KEY.lower, KEY.median and KEY.upper, which are infinite for
/// a run that did not succeed.
///
/// With `success`, a summary has the share of runs that follow the ground truth, with Wilson's interval; median, nine
/// of ten and worst of the ATE in percent of the path; and the number of runs whose status is ok although their ATE is
/// more than twice as large as that bound.
///
/// The format "long" is a CSV with a line per run and metric (by default all known ones), and with the columns that
/// distinguish the runs: pandas and R can read it directly.
///
/// Throws InputError if there is no run, if no run has a value of a column, with the nearest known name, if causal
/// scores are requested and no run has them, for `over` and `by` together or columns of them in which runs do not
/// differ, or if two runs of a row have the same seed (or other value of `over`) but are not the same job.
std::string make_table(std::span<const RunRecord> runs, const TableOptions& options);

/// The same table before it is formatted, all its columns, with the runs of its rows. Not for "long".
struct TextTable;
TextTable text_table(std::span<const RunRecord> runs, const TableOptions& options);

/// A line for each number that any of the runs has: its key for TableOptions::metrics, and its header.
std::string list_metrics(std::span<const RunRecord> runs);

/// Whether a table of so many runs shows scores over common time (bench/scores_by_protocol.hpp). They take long,
/// because the runs are scored again: tables of more than kCommonTimeRuns runs have them only by request.
bool shows_common_time(const TableOptions& options, std::size_t runs);
/// Whether any of these metrics is of common time.
bool any_of_common_time(const std::vector<std::string>& metrics);
inline constexpr std::size_t kCommonTimeRuns = 500;

}  // namespace evbench
