#include "eval/table.hpp"

#include <cmath>
#include <optional>
#include <set>

#include "core/support/index.hpp"
#include "eval/protocol.hpp"
#include "eval/table_metrics.hpp"
#include "eval/table_text.hpp"

namespace evbench {
namespace {

using Cell = TextTable::Cell;

std::string status_text(const Row& row, TableFormat format) {
  if (!row.run->status) return format == TableFormat::csv ? "" : "-";
  const Status& status = row.run->status->status;
  const std::string state = to_string(status.state);
  if (format == TableFormat::csv || status.state == RunState::ok) return state;
  return fmt::format("{} at {:.2f} s", state, status.time);
}

/// Decimals with which the smallest value other than 0 shows three digits, 1 to 6.
int decimals_of(const std::vector<std::optional<double>>& values) {
  double smallest = std::numeric_limits<double>::infinity();
  for (const auto& value : values) {
    if (value && *value != 0.0) smallest = std::min(smallest, std::abs(*value));
  }
  if (!std::isfinite(smallest)) return 1;
  return std::clamp(2 - static_cast<int>(std::floor(std::log10(smallest))), 1, 6);
}

/// Runs that can be compared with one another: of one experiment, scored by one protocol.
struct Group {
  std::string experiment;
  int protocol = 0;
  bool operator==(const Group&) const = default;
};

/// Marks the best cells of a column within each group, unless all say the same.
void mark_best(const Rows& rows, const std::vector<Group>& groups, const std::vector<std::optional<double>>& values,
               Better better, std::vector<Cell>& cells) {
  if (better == Better::neither) return;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    bool best = values[i] && rows[i].run->competes();
    bool differs = false;
    for (std::size_t k = 0; k < rows.size() && best; ++k) {
      if (groups[k] != groups[i] || !values[k] || !rows[k].run->competes() || cells[k].text == cells[i].text) continue;
      differs = true;
      best = better == Better::lower ? *values[i] < *values[k] : *values[i] > *values[k];
    }
    cells[i].best = best && differs;
  }
}

std::vector<Cell> metric_cells(const Rows& rows, const std::vector<Group>& groups, const Metric& metric,
                               const TableOptions& options) {
  const bool csv = options.format == TableFormat::csv;
  std::vector<std::optional<double>> values;
  for (const Row& row : rows) {
    values.push_back(value_of(row, metric.key, options.online));
    if (values.back() && !csv) *values.back() *= metric.factor;
  }
  const int decimals = metric.decimals ? *metric.decimals : decimals_of(values);
  std::vector<Cell> cells;
  for (const auto& value : values) {
    if (!value) {
      cells.push_back({csv ? "" : "-"});
    } else {
      cells.push_back({csv ? fmt::format("{}", *value) : fmt::format("{:.{}f}", *value, decimals)});
    }
  }
  mark_best(rows, groups, values, metric.better, cells);
  return cells;
}

/// The distinct protocols and each run's number among them; -1 for a run without scores.
struct Protocols {
  std::vector<std::string> texts;
  std::vector<int> of_run;
};

Protocols collect_protocols(const Rows& rows, bool online) {
  Protocols result;
  for (const Row& row : rows) {
    const Json& scores = scores_of(row, online);
    if (scores.is_null()) {
      result.of_run.push_back(-1);
      continue;
    }
    const std::string text = protocol(scores, row.run->folder + "/metrics.json");
    const auto found = std::ranges::find(result.texts, text);
    result.of_run.push_back(static_cast<int>(found - result.texts.begin()));
    if (found == result.texts.end()) result.texts.push_back(text);
  }
  if (result.texts.empty() && online)
    throw InputError(fmt::format("none of the {} runs has online scores", rows.size()));
  return result;
}

/// Pairs, coverage, scale as ranges, as far as they are no columns.
std::string ranges_note(const Rows& rows, const std::vector<Metric>& shown, bool online) {
  std::string note;
  for (const char* key : {"pairs", "coverage", "scale"}) {
    if (std::ranges::find(shown, key, &Metric::key) != shown.end()) continue;
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const Row& row : rows) {
      if (const auto value = value_of(row, key, online)) {
        low = std::min(low, *value);
        high = std::max(high, *value);
      }
    }
    if (low > high) continue;
    const Metric metric = metric_of(key);
    note += fmt::format("{}{} {:.{}f} to {:.{}f}", note.empty() ? "" : "; ", metric.header, metric.factor * low,
                        *metric.decimals, metric.factor * high, *metric.decimals);
  }
  return note.empty() ? note : note + ".";
}

/// What went wrong with a run, and why.
struct Trouble {
  std::string what, reason;
  bool operator==(const Trouble&) const = default;
};

/// None where a run was neither lost nor left without scores. The reason of its status tells most.
std::optional<Trouble> trouble_of(const Row& row, bool online) {
  const RunRecord& run = *row.run;
  const std::string reason = run.competes() ? "" : run.status->status.reason;
  const bool scored = !scores_of(row, online).is_null();
  const bool degraded = run.status && run.status->status.state == RunState::degraded;
  if (scored && degraded) return Trouble{"Degraded", run.status->status.reason};
  if (scored && run.competes()) return std::nullopt;
  const std::string& unscored = online ? run.online_unscored : run.final_unscored;
  const std::string what = !scored ? "Without scores" : run.status->status.state == RunState::lost ? "Lost" : "Failed";
  return Trouble{what, !reason.empty() ? reason : !unscored.empty() ? unscored : "not known"};
}

/// A sentence for each trouble, with the runs that had it.
std::vector<std::string> trouble_notes(const Rows& rows, const std::vector<std::string>& names, bool online) {
  std::vector<std::pair<Trouble, std::string>> troubles;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const std::optional<Trouble> trouble = trouble_of(rows[i], online);
    if (!trouble) continue;
    const auto found = std::ranges::find(troubles, *trouble, &std::pair<Trouble, std::string>::first);
    if (found == troubles.end()) {
      troubles.emplace_back(*trouble, names[i]);
    } else {
      found->second += "; " + names[i];
    }
  }
  std::vector<std::string> notes;
  for (const auto& [trouble, who] : troubles)
    notes.push_back(fmt::format("{}: {}: {}.", trouble.what, who, trouble.reason));
  return notes;
}

/// The time that the runs of each experiment have in common.
std::vector<std::string> common_time_notes(const Rows& rows) {
  std::vector<std::string> notes;
  for (const Row& row : rows) {
    if (row.run->common_scores.is_null()) continue;
    const Json& range = row.run->common_scores.at("association").at("time_range_s");
    std::string note = fmt::format("Common time: {:.2f} to {:.2f} s, which every run covers that was not lost.",
                                   range.at(0).get<double>(), range.at(1).get<double>());
    if (std::ranges::find(notes, note) == notes.end()) notes.push_back(std::move(note));
  }
  return notes;
}

std::vector<std::string> notes_of(const Rows& rows, const std::vector<std::string>& names,
                                  const std::vector<Metric>& metrics, const Protocols& protocols,
                                  const TableOptions& options) {
  const auto shown = [&](const char* key) { return std::ranges::find(metrics, key, &Metric::key) != metrics.end(); };
  std::vector<std::string> notes;
  if (protocols.texts.empty()) {
    notes.emplace_back("No run has scores.");
  } else {
    const bool of_runs = std::ranges::any_of(rows, [](const Row& row) { return row.run->status.has_value(); });
    notes.emplace_back(options.online ? "Online: each pose as estimated at the time it was made. "
                       : of_runs      ? "Final: the trajectory as estimated after the whole sequence. "
                                      : "");
    notes.back() += "ATE and RPE columns are root mean squares unless they say otherwise.";
  }
  for (std::size_t i = 0; i < protocols.texts.size(); ++i) {
    const std::string number = protocols.texts.size() > 1 ? fmt::format(" {}", i + 1) : "";
    notes.push_back(fmt::format("Protocol{}: {}.", number, protocols.texts[i]));
  }
  if (const std::string ranges = ranges_note(rows, metrics, options.online); !ranges.empty()) notes.push_back(ranges);
  if (std::ranges::any_of(metrics, [](const Metric& metric) { return metric.key.starts_with("common."); })) {
    std::ranges::move(common_time_notes(rows), std::back_inserter(notes));
  }
  if (shown("realtime_factor")) {
    notes.emplace_back(
        "Real-time factor: data time / processing time (front-end and back-end); above 1 is faster than "
        "real time.");
  }
  std::ranges::move(trouble_notes(rows, names, options.online), std::back_inserter(notes));
  if (!std::ranges::all_of(rows, [](const Row& row) { return row.run->competes(); }))
    notes.emplace_back("Lost and failed runs do not compete for the best value.");
  return notes;
}

/// A column of texts.
void add_column(TextTable& table, const std::string& header, bool number, std::vector<Cell> cells) {
  table.columns.push_back({header, number});
  for (std::size_t i = 0; i < cells.size(); ++i) table.rows[i].push_back(std::move(cells[i]));
}

template <class Function>
void add_text_column(TextTable& table, const Rows& rows, const std::string& header, const Function& text) {
  std::vector<Cell> cells;
  for (const Row& row : rows) cells.push_back({text(*row.run)});
  add_column(table, header, false, std::move(cells));
}

/// Do these values differ among the runs?
template <class Function>
bool vary(const Rows& rows, const Function& value) {
  return std::ranges::any_of(rows, [&](const Row& row) { return value(*row.run) != value(*rows.front().run); });
}

std::string seed_text(const RunRecord& run) { return run.seed ? fmt::format("{}", *run.seed) : ""; }

/// The settings in which runs of one name, label and experiment, differ: what the name doesn't tell.
std::vector<std::string> varying_settings(const Rows& rows) {
  std::vector<std::string> varying;
  for (const Row& row : rows) {
    const RunRecord& run = *row.run;
    for (const auto& [path, value] : run.settings) {
      const auto differs = [&](const Row& other) {
        const Json* theirs = find_setting(other.run->settings, path);
        return other.run->experiment == run.experiment && other.run->label == run.label &&
               (theirs == nullptr || *theirs != value);
      };
      const bool known = std::ranges::find(varying, path) != varying.end();
      if (!known && std::ranges::any_of(rows, differs)) varying.push_back(path);
    }
  }
  return varying;
}

std::string setting_text(const RunRecord& run, const std::string& path) {
  const Json* value = find_setting(run.settings, path);
  if (value == nullptr || value->is_null()) return "";
  return value->is_string() ? value->get<std::string>() : value->dump();
}

/// Are there rows that no cell tells apart?
bool ambiguous(const TextTable& table) {
  std::set<std::vector<std::string>> seen;
  return !std::ranges::all_of(table.rows, [&](const std::vector<Cell>& cells) {
    std::vector<std::string> texts;
    for (const Cell& cell : cells) texts.push_back(cell.text);
    return seen.insert(std::move(texts)).second;
  });
}

/// What tells the runs apart; in CSV all that does, else as much as is needed.
void add_names(TextTable& table, const Rows& rows, bool csv) {
  const auto experiment = [](const RunRecord& run) { return run.experiment; };
  if (csv || vary(rows, experiment)) add_text_column(table, rows, "experiment", experiment);
  add_text_column(table, rows, csv ? "label" : "", [](const RunRecord& run) { return run.label; });
  for (const std::string& path : varying_settings(rows)) {
    add_text_column(table, rows, path, [&](const RunRecord& run) { return setting_text(run, path); });
  }
  if (csv || vary(rows, seed_text)) add_text_column(table, rows, "seed", seed_text);
  if (csv || ambiguous(table)) add_text_column(table, rows, "key", [](const RunRecord& run) { return run.key; });
  if (csv || ambiguous(table)) add_text_column(table, rows, "folder", [](const RunRecord& run) { return run.folder; });
}

/// What each run is called in notes: by its label, and by the rest of its name where others have the same label.
std::vector<std::string> short_names(const TextTable& table, const Rows& rows) {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const std::string& label = rows[i].run->label;
    names.push_back(label);
    const auto same = [&](const Row& row) { return row.run->label == label; };
    if (std::ranges::count_if(rows, same) == 1) continue;
    std::string rest;
    for (std::size_t c = 0; c < table.columns.size(); ++c) {
      if (table.columns[c].header.empty()) continue;  // the label
      rest += fmt::format("{}{} {}", rest.empty() ? "" : ", ", table.columns[c].header, table.rows[i][c].text);
    }
    if (!rest.empty()) names.back() += fmt::format(" ({})", rest);
  }
  return names;
}

bool all_fine(const Rows& rows) {
  return std::ranges::all_of(
      rows, [](const Row& row) { return !row.run->status || row.run->status->status.state == RunState::ok; });
}

std::vector<std::string> distinct_experiments(const Rows& rows) {
  std::vector<std::string> names;
  for (const Row& row : rows) {
    if (std::ranges::find(names, row.run->experiment) == names.end()) names.push_back(row.run->experiment);
  }
  return names;
}

}  // namespace

std::string make_table(std::span<const RunRecord> runs, const TableOptions& options) {
  if (runs.empty()) throw InputError("there is no run to make a table of");
  const bool csv = options.format == TableFormat::csv;
  Rows rows;
  for (const RunRecord& run : runs) {
    rows.push_back({&run, to_json(run)});
    rows.back().metrics["common"] = run.common_scores;
  }
  const Protocols protocols = collect_protocols(rows, options.online);
  const std::vector<Metric> metrics = choose_metrics(rows, options);
  std::vector<Group> groups;
  for (std::size_t i = 0; i < rows.size(); ++i) groups.push_back({runs[i].experiment, protocols.of_run[i]});

  TextTable table;
  table.rows.resize(rows.size());
  add_names(table, rows, csv);
  const std::vector<std::string> names = short_names(table, rows);
  for (const Metric& metric : metrics) {
    add_column(table, csv ? metric.key : metric.header, true, metric_cells(rows, groups, metric, options));
  }
  if (options.format != TableFormat::latex || !all_fine(rows)) {
    std::vector<Cell> states;
    for (const Row& row : rows) states.push_back({status_text(row, options.format)});
    add_column(table, "status", false, std::move(states));
  }
  if (csv)
    add_column(table, "trajectory", false, std::vector<Cell>(rows.size(), {options.online ? "online" : "final"}));
  if (csv || protocols.texts.size() > 1) {
    std::vector<Cell> cells;
    for (const int number : protocols.of_run) {
      const std::string none = csv ? "" : "-";
      const std::string known = fmt::format("{}", number + 1);
      cells.push_back({number < 0 ? none : csv ? protocols.texts[index(number)] : known});
    }
    add_column(table, "protocol", false, std::move(cells));
  }
  table.experiments = distinct_experiments(rows);
  if (table.experiments.size() == 1 && options.format != TableFormat::latex) {
    table.notes.push_back(fmt::format("Experiment: {}.", runs[0].experiment));
  }
  std::ranges::move(notes_of(rows, names, metrics, protocols, options), std::back_inserter(table.notes));
  return format_table(table, options.format);
}

}  // namespace evbench
