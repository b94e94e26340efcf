#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>
#include <tuple>

#include "core/support/index.hpp"
#include "eval/table_parts.hpp"

namespace evbench {
namespace {

using Cell = TextTable::Cell;
using Values = std::vector<std::optional<double>>;

/// Groups of runs that can be compared: of one experiment and sequence, scored by one protocol. If the source is not
/// known, as for compared files, only the seed distinguishes sequences.
std::vector<std::vector<std::size_t>> comparable_runs(const TableRuns& runs) {
  std::map<std::tuple<std::string, std::string, int>, std::vector<std::size_t>> groups;
  for (std::size_t i = 0; i < runs.runs.size(); ++i) {
    const RunRecord& run = runs.runs[i].run();
    const std::string sequence = !run.settings.empty() ? sequence_of(run)
                                 : run.seed            ? fmt::format("{}", *run.seed)
                                                       : "";
    groups[{run.experiment, sequence, runs.protocols.of_run[i]}].push_back(i);
  }
  std::vector<std::vector<std::size_t>> result;
  for (auto& [name, group] : groups) result.push_back(std::move(group));
  return result;
}

/// Marks the best cells of a column within a group, unless all are equal.
void mark_best(const TableRuns& runs, const std::vector<std::size_t>& group, const Values& values, Better better,
               std::vector<Cell>& cells) {
  std::vector<std::size_t> competing;
  std::ranges::copy_if(group, std::back_inserter(competing),
                       [&](std::size_t i) { return values[i] && runs.runs[i].run().competes(); });
  if (better == Better::neither || competing.empty()) return;
  const auto is_better = [&](std::size_t a, std::size_t b) {
    return better == Better::lower ? *values[a] < *values[b] : *values[a] > *values[b];
  };
  const std::string& best = cells[*std::ranges::min_element(competing, is_better)].text;
  const auto says_best = [&](std::size_t i) { return cells[i].text == best; };
  if (std::ranges::all_of(competing, says_best)) return;
  std::vector<std::size_t> marked;
  std::ranges::copy_if(competing, std::back_inserter(marked), says_best);
  for (const std::size_t i : marked) cells[i].best = true;
}

std::vector<Cell> metric_cells(const TableRuns& runs, const Metric& metric, bool csv) {
  Values values;
  for (const RunNumbers& run : runs.runs) {
    values.push_back(run.at(metric.key));
    if (values.back() && !csv) *values.back() *= metric.factor;
  }
  const int decimals = metric.decimals.value_or(decimals_of(values));
  std::vector<Cell> cells;
  for (const auto& value : values) {
    if (!value) {
      cells.push_back({csv ? "" : "-"});
    } else {
      cells.push_back({csv ? fmt::format("{}", *value) : fmt::format("{:.{}f}", *value, decimals), false, "", *value});
    }
  }
  if (!csv) {
    for (const auto& group : comparable_runs(runs)) mark_best(runs, group, values, metric.better, cells);
  }
  return cells;
}

std::vector<Cell> cells_of(const std::vector<std::string>& texts) {
  std::vector<Cell> cells;
  for (const std::string& text : texts) cells.push_back({text});
  return cells;
}

template <class Text>
std::vector<Cell> cells_of(const TableRuns& runs, const Text& text) {
  std::vector<Cell> cells;
  for (const RunNumbers& run : runs.runs) cells.push_back({text(run.run())});
  return cells;
}

std::string folder_of(const RunRecord& run) { return run.folder; }

/// Whether any two rows have equal cells.
bool ambiguous(const TextTable& table) {
  std::set<std::vector<std::string>> seen;
  return !std::ranges::all_of(table.rows, [&](const std::vector<Cell>& cells) {
    std::vector<std::string> texts;
    for (const Cell& cell : cells) texts.push_back(cell.text);
    return seen.insert(std::move(texts)).second;
  });
}

/// Adds the columns that distinguish the runs: in CSV all of them, else as many as are needed.
void add_names(TextTable& table, const TableRuns& runs, const TableOptions& options) {
  const bool csv = options.format == TableFormat::csv, print = options.format == TableFormat::latex;
  for (const RunColumn& column : runs.columns) {
    const bool label = column.name == "label";
    if (!csv && !label && !column.varies()) continue;
    add_column(table, label && !csv ? "" : column.name, false, cells_of(column.values));
  }
  const auto key = [](const RunRecord& run) { return run.key; };
  const bool keys = csv || asks_for(options, "key") || ambiguous(table);
  if (keys) add_column(table, "key", false, cells_of(runs, key));
  if (csv || (!print && ambiguous(table))) add_column(table, "folder", false, cells_of(runs, folder_of));
}

/// The note that explains the mark of the best values, if there is one.
std::string mark_note(const TextTable& table, const TableRuns& runs, TableFormat format) {
  const auto marked = [](const std::vector<Cell>& cells) { return std::ranges::any_of(cells, &Cell::best); };
  const bool any = std::ranges::any_of(table.rows, marked);
  std::string note;
  if (any)
    note = fmt::format("{}: the best of a column among runs of one sequence, seed and protocol.", mark_name(format));
  if (std::ranges::any_of(runs.runs, [](const RunNumbers& run) { return run.run().done && !run.run().competes(); })) {
    note += fmt::format("{}Lost and failed runs do not compete for the best value.", any ? " " : "");
  }
  return note;
}

bool all_fine(const TableRuns& runs) {
  return std::ranges::all_of(runs.runs, [](const RunNumbers& numbers) {
    const RunRecord& run = numbers.run();
    return run.done && (!run.status || status_text(numbers) == to_string(RunState::ok));
  });
}

}  // namespace

TextTable run_table(const TableRuns& runs, const TableOptions& options) {
  const bool csv = options.format == TableFormat::csv;
  TextTable table;
  table.rows.resize(runs.runs.size());
  add_names(table, runs, options);
  for (const Metric& metric : runs.metrics) {
    add_column(table, csv ? metric.key : header_of(metric, options.format), true, metric_cells(runs, metric, csv),
               rank_of(metric, options), metric.key);
  }
  for (std::size_t i = 0; i < runs.runs.size(); ++i) table.runs.push_back({i});
  const bool print = options.format == TableFormat::latex;
  if (!print || !all_fine(runs) || asks_for(options, "status")) {
    std::vector<Cell> cells;
    for (const RunNumbers& run : runs.runs) {
      const std::string word = status_word(run.run());
      const bool short_word = csv || (print && word != to_string(RunState::ok));
      cells.push_back({short_word ? word : status_text(run)});
    }
    add_column(table, "status", false, std::move(cells));
    if (csv) add_column(table, "reason", false, cells_of(runs, status_reason));
  }
  if (csv) {
    const char* trajectory = options.causal ? "causal" : "final";
    add_column(table, "trajectory", false, std::vector<Cell>(runs.runs.size(), {trajectory}));
  }
  if (csv || runs.protocols.texts.size() > 1) {
    std::vector<Cell> cells;
    for (const int number : runs.protocols.of_run) {
      const std::string none = csv ? "" : "-";
      const std::string known = fmt::format("{}", number + 1);
      cells.push_back({number < 0 ? none : csv ? runs.protocols.texts[index(number)] : known});
    }
    add_column(table, "protocol", false, std::move(cells));
  }
  const bool has_folder = std::ranges::find(table.columns, "folder", &TextTable::Column::header) != table.columns.end();
  if ((options.folders || asks_for(options, "folder")) && !has_folder) {
    add_column(table, "folder", false, cells_of(runs, folder_of));
  }
  table.notes = table_notes(runs.runs, run_names(runs.columns), runs.metrics, runs.protocols, options);
  if (std::string note = mark_note(table, runs, options.format); !note.empty()) table.notes.push_back(std::move(note));
  return table;
}

}  // namespace evbench
