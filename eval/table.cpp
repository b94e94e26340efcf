#include "eval/table.hpp"

#include <cmath>
#include <optional>
#include <set>
#include <tuple>

#include "core/support/index.hpp"
#include "eval/protocol.hpp"
#include "eval/table_text.hpp"

namespace evbench {
namespace {

using Cell = TextTable::Cell;

/// A run and what metrics.json says of it, where columns are looked up.
struct Row {
  const RunRecord* run;
  Json metrics;
};
using Rows = std::vector<Row>;

enum class Better { neither, lower, higher };

/// A column: a number found in every run's metrics.
struct Metric {
  std::string key;     ///< path into metrics.json or into its scores
  std::string header;  ///< for people
  Better better = Better::neither;
  std::optional<int> decimals = {};  ///< fixed; else as many as the smallest value of the column needs for three digits
  double factor = 1.0;               ///< shown is factor times the value
};

const std::vector<Metric>& known_metrics() {
  static const std::vector<Metric> metrics = {
      {"ate.trans_m.rmse", "ATE [m]", Better::lower},
      {"ate.trans_percent", "ATE [% of path]", Better::lower},
      {"ate.rot_deg.rmse", "ATE [deg]", Better::lower},
      {"rpe.trans_m.rmse", "RPE [m]", Better::lower},
      {"rpe.rot_deg.rmse", "RPE [deg]", Better::lower},
      {"pairs", "pairs", Better::neither, 0},
      {"coverage", "covered [%]", Better::neither, 1, 100.0},
      {"scale", "scale", Better::neither, 4},
      {"times.frontend_s", "front-end [s]", Better::neither, 3},
      {"times.backend_s", "back-end [s]", Better::lower, 3},
      {"times.waiting_s", "waiting [s]", Better::neither, 3},
      {"realtime_factor", "real-time factor", Better::higher},
  };
  return metrics;
}

Metric metric_of(const std::string& key) {
  const auto found = std::ranges::find(known_metrics(), key, &Metric::key);
  if (found != known_metrics().end()) return *found;
  const bool error = (key.starts_with("ate.") || key.starts_with("rpe.")) && !key.ends_with(".n");
  const bool cost = key == "runtime_s" || key == "peak_rss_mib" || key.starts_with("times.");
  return {key, key, error || cost ? Better::lower : Better::neither};
}

const Json& scores_of(const Row& row, bool online) { return online ? row.run->online_scores : row.run->final_scores; }

/// The number at a path like "ate.trans_m.rmse", if there is one.
std::optional<double> number_at(const Json& root, const std::string& key) {
  const Json* node = &root;
  for (std::size_t at = 0; at <= key.size();) {
    const std::size_t stop = std::min(key.find('.', at), key.size());
    if (!node->is_object()) return std::nullopt;
    const auto found = node->find(key.substr(at, stop - at));
    if (found == node->end()) return std::nullopt;
    node = &*found;
    at = stop + 1;
  }
  return node->is_number() ? std::optional(node->get<double>()) : std::nullopt;
}

std::optional<double> value_of(const Row& row, const std::string& key, bool online) {
  const std::optional<double> score = number_at(scores_of(row, online), key);
  return score ? score : number_at(row.metrics, key);
}

/// The paths of all numbers in a JSON object.
void list_numbers(const Json& node, const std::string& prefix, std::vector<std::string>& keys) {
  if (!node.is_object()) return;
  for (const auto& [key, value] : node.items()) {
    if (value.is_number() && std::ranges::find(keys, prefix + key) == keys.end()) keys.push_back(prefix + key);
    list_numbers(value, prefix + key + ".", keys);
  }
}

[[noreturn]] void fail_unknown(const Rows& rows, const std::string& key, bool online) {
  std::vector<std::string> known;
  for (const Row& row : rows) {
    list_numbers(scores_of(row, online), "", known);
    Json others = row.metrics;
    others.erase("final");
    others.erase("online");
    list_numbers(others, "", known);
  }
  throw InputError(fmt::format("no run has the metric \"{}\"{}", key, suggestion(key, known)));
}

/// The columns to show: those asked for, else the default ones that at least one run has.
std::vector<Metric> choose_metrics(const Rows& rows, const TableOptions& options) {
  const auto present = [&](const std::string& key) {
    return std::ranges::any_of(rows, [&](const Row& row) { return value_of(row, key, options.online).has_value(); });
  };
  std::vector<Metric> metrics;
  for (const std::string& key : options.metrics) {
    if (!present(key)) fail_unknown(rows, key, options.online);
    metrics.push_back(metric_of(key));
  }
  const auto waited = [](const Row& row) { return row.run->times && row.run->times->waiting > 0.0; };
  for (const Metric& metric : known_metrics()) {
    if (metric.key == "times.waiting_s" && std::ranges::none_of(rows, waited)) continue;  // all ran in one thread
    const bool protocol_value = metric.key == "pairs" || metric.key == "coverage" || metric.key == "scale";
    const bool wanted =
        options.metrics.empty() || (options.format == TableFormat::csv && protocol_value &&
                                    std::ranges::find(options.metrics, metric.key) == options.metrics.end());
    if (wanted && present(metric.key)) metrics.push_back(metric);
  }
  return metrics;
}

bool competes(const Row& row) { return !row.run->status || row.run->status->status.state < RunState::lost; }

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
    bool best = values[i] && competes(rows[i]);
    bool differs = false;
    for (std::size_t k = 0; k < rows.size() && best; ++k) {
      if (groups[k] != groups[i] || !values[k] || !competes(rows[k]) || cells[k].text == cells[i].text) continue;
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

/// Why a run has no scores: the reason of its status tells most.
std::string reason_of(const Row& row, bool online) {
  const RunRecord& run = *row.run;
  if (run.status && run.status->status.state >= RunState::lost && !run.status->status.reason.empty()) {
    return run.status->status.reason;
  }
  const std::string& unscored = online ? run.online_unscored : run.final_unscored;
  return unscored.empty() ? "not known" : unscored;
}

/// A sentence for each reason why runs have no scores, with the runs that it holds for.
std::vector<std::string> unscored_notes(const Rows& rows, bool online) {
  std::vector<std::pair<std::string, std::string>> labels_of_reason;
  for (const Row& row : rows) {
    if (!scores_of(row, online).is_null()) continue;
    const std::string reason = reason_of(row, online);
    const auto found = std::ranges::find(labels_of_reason, reason, &std::pair<std::string, std::string>::first);
    if (found == labels_of_reason.end()) {
      labels_of_reason.emplace_back(reason, row.run->label);
    } else {
      found->second += ", " + row.run->label;
    }
  }
  std::vector<std::string> notes;
  for (const auto& [reason, labels] : labels_of_reason) {
    notes.push_back(fmt::format("Without scores: {}: {}.", labels, reason));
  }
  return notes;
}

std::vector<std::string> notes_of(const Rows& rows, const std::vector<Metric>& metrics, const Protocols& protocols,
                                  const TableOptions& options) {
  const auto shown = [&](const char* key) { return std::ranges::find(metrics, key, &Metric::key) != metrics.end(); };
  std::vector<std::string> notes;
  if (protocols.texts.empty()) {
    notes.emplace_back("No run has scores.");
  } else {
    notes.emplace_back(options.online ? "Online: each pose as estimated at the time it was made."
                                      : "Final: the trajectory as estimated after the whole sequence.");
    notes.back() += " ATE and RPE columns are root mean squares unless they say otherwise.";
  }
  for (std::size_t i = 0; i < protocols.texts.size(); ++i) {
    const std::string number = protocols.texts.size() > 1 ? fmt::format(" {}", i + 1) : "";
    notes.push_back(fmt::format("Protocol{}: {}.", number, protocols.texts[i]));
  }
  if (const std::string ranges = ranges_note(rows, metrics, options.online); !ranges.empty()) notes.push_back(ranges);
  if (shown("realtime_factor")) {
    notes.emplace_back(
        "Real-time factor: data time / processing time (front-end and back-end); above 1 is faster than "
        "real time.");
  }
  for (const std::string& note : unscored_notes(rows, options.online)) notes.push_back(note);
  if (!std::ranges::all_of(rows, competes))
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

/// Do two rows have the same experiment, label and seed?
bool ambiguous(const Rows& rows) {
  std::set<std::tuple<std::string, std::string, std::optional<std::uint64_t>>> seen;
  return !std::ranges::all_of(
      rows, [&](const Row& row) { return seen.emplace(row.run->experiment, row.run->label, row.run->seed).second; });
}

/// What tells the runs apart; in CSV all that does, else as much as is needed.
void add_names(TextTable& table, const Rows& rows, bool csv) {
  const auto experiment = [](const RunRecord& run) { return run.experiment; };
  if (csv || vary(rows, experiment)) add_text_column(table, rows, "experiment", experiment);
  add_text_column(table, rows, csv ? "label" : "", [](const RunRecord& run) { return run.label; });
  if (csv || vary(rows, seed_text)) add_text_column(table, rows, "seed", seed_text);
  if (csv || ambiguous(rows)) add_text_column(table, rows, "key", [](const RunRecord& run) { return run.key; });
  if (csv) add_text_column(table, rows, "folder", [](const RunRecord& run) { return run.folder; });
}

}  // namespace

std::string make_table(std::span<const RunRecord> runs, const TableOptions& options) {
  if (runs.empty()) throw InputError("there is no run to make a table of");
  const bool csv = options.format == TableFormat::csv;
  Rows rows;
  for (const RunRecord& run : runs) rows.push_back({&run, to_json(run)});
  const Protocols protocols = collect_protocols(rows, options.online);
  const std::vector<Metric> metrics = choose_metrics(rows, options);
  std::vector<Group> groups;
  for (std::size_t i = 0; i < rows.size(); ++i) groups.push_back({runs[i].experiment, protocols.of_run[i]});

  TextTable table;
  table.rows.resize(rows.size());
  add_names(table, rows, csv);
  for (const Metric& metric : metrics) {
    add_column(table, csv ? metric.key : metric.header, true, metric_cells(rows, groups, metric, options));
  }
  std::vector<Cell> states;
  for (const Row& row : rows) states.push_back({status_text(row, options.format)});
  add_column(table, "status", false, std::move(states));
  if (csv || protocols.texts.size() > 1) {
    std::vector<Cell> cells;
    for (const int number : protocols.of_run) {
      const std::string none = csv ? "" : "-";
      const std::string known = fmt::format("{}", number + 1);
      cells.push_back({number < 0 ? none : csv ? protocols.texts[index(number)] : known});
    }
    add_column(table, "protocol", false, std::move(cells));
  }
  if (!vary(rows, [](const RunRecord& run) { return run.experiment; })) {
    table.notes.push_back(fmt::format("Experiment: {}.", runs[0].experiment));
  }
  std::ranges::move(notes_of(rows, metrics, protocols, options), std::back_inserter(table.notes));
  return format_table(table, options.format);
}

}  // namespace evbench
