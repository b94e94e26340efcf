#include "eval/table.hpp"

#include <cmath>
#include <optional>

#include "eval/protocol.hpp"
#include "eval/table_text.hpp"

namespace evbench {
namespace {

using Cell = TextTable::Cell;

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
      {"ate.trans_m.rmse", "ATE [m]", Better::lower},          {"ate.trans_percent", "ATE [% of path]", Better::lower},
      {"ate.rot_deg.rmse", "ATE [deg]", Better::lower},        {"rpe.trans_m.rmse", "RPE [m]", Better::lower},
      {"rpe.rot_deg.rmse", "RPE [deg]", Better::lower},        {"pairs", "pairs", Better::neither, 0},
      {"coverage", "covered [%]", Better::neither, 1, 100.0},  {"scale", "scale", Better::neither, 4},
      {"realtime_factor", "real-time factor", Better::higher},
  };
  return metrics;
}

Metric metric_of(const std::string& key) {
  const auto found = std::ranges::find(known_metrics(), key, &Metric::key);
  if (found != known_metrics().end()) return *found;
  const bool error = (key.starts_with("ate.") || key.starts_with("rpe.")) && !key.ends_with(".n");
  const bool cost = key == "runtime_s" || key == "peak_rss_mib";
  return {key, key, error || cost ? Better::lower : Better::neither};
}

const Json& scores_of(const RunMetrics& run, bool online) { return run.metrics.at(online ? "online" : "final"); }

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

std::optional<double> value_of(const RunMetrics& run, const std::string& key, bool online) {
  const std::optional<double> score = number_at(scores_of(run, online), key);
  return score ? score : number_at(run.metrics, key);
}

/// The paths of all numbers in a JSON object.
void list_numbers(const Json& node, const std::string& prefix, std::vector<std::string>& keys) {
  if (!node.is_object()) return;
  for (const auto& [key, value] : node.items()) {
    if (value.is_number() && std::ranges::find(keys, prefix + key) == keys.end()) keys.push_back(prefix + key);
    list_numbers(value, prefix + key + ".", keys);
  }
}

[[noreturn]] void fail_unknown(std::span<const RunMetrics> runs, const std::string& key, bool online) {
  std::vector<std::string> known;
  for (const RunMetrics& run : runs) {
    list_numbers(scores_of(run, online), "", known);
    for (const auto& [name, value] : run.metrics.items()) {
      if (value.is_number() && std::ranges::find(known, name) == known.end()) known.push_back(name);
    }
  }
  throw InputError(fmt::format("no run has the metric \"{}\"{}", key, suggestion(key, known)));
}

/// The columns to show: those asked for, else the default ones that at least one run has.
std::vector<Metric> choose_metrics(std::span<const RunMetrics> runs, const TableOptions& options) {
  const auto present = [&](const std::string& key) {
    return std::ranges::any_of(runs,
                               [&](const RunMetrics& run) { return value_of(run, key, options.online).has_value(); });
  };
  std::vector<Metric> metrics;
  for (const std::string& key : options.metrics) {
    if (!present(key)) fail_unknown(runs, key, options.online);
    metrics.push_back(metric_of(key));
  }
  for (const Metric& metric : known_metrics()) {
    const bool protocol_value = metric.key == "pairs" || metric.key == "coverage" || metric.key == "scale";
    const bool wanted =
        options.metrics.empty() || (options.format == TableFormat::csv && protocol_value &&
                                    std::ranges::find(options.metrics, metric.key) == options.metrics.end());
    if (wanted && present(metric.key)) metrics.push_back(metric);
  }
  return metrics;
}

bool competes(const RunMetrics& run) {
  const auto status = run.metrics.find("status");
  if (status == run.metrics.end() || !status->is_object()) return true;
  const std::string state = status->value("state", "");
  return state != "lost" && state != "failed";
}

std::string status_text(const RunMetrics& run, TableFormat format) {
  const std::string none = format == TableFormat::csv ? "" : "-";
  const auto status = run.metrics.find("status");
  if (status == run.metrics.end() || !status->is_object()) return none;
  const std::optional<double> time = number_at(*status, "time");
  const auto state = status->find("state");
  if (state == status->end() || !state->is_string()) return none;
  const auto text = state->get<std::string>();
  if (format == TableFormat::csv || text == "ok" || !time) return text;
  return fmt::format("{} at {:.2f} s", text, *time);
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
void mark_best(std::span<const RunMetrics> runs, const std::vector<Group>& groups,
               const std::vector<std::optional<double>>& values, Better better, std::vector<Cell>& cells) {
  if (better == Better::neither) return;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    bool best = values[i] && competes(runs[i]);
    bool differs = false;
    for (std::size_t k = 0; k < runs.size() && best; ++k) {
      if (groups[k] != groups[i] || !values[k] || !competes(runs[k]) || cells[k].text == cells[i].text) continue;
      differs = true;
      best = better == Better::lower ? *values[i] < *values[k] : *values[i] > *values[k];
    }
    cells[i].best = best && differs;
  }
}

std::vector<Cell> metric_cells(std::span<const RunMetrics> runs, const std::vector<Group>& groups, const Metric& metric,
                               const TableOptions& options) {
  const bool csv = options.format == TableFormat::csv;
  std::vector<std::optional<double>> values;
  for (const RunMetrics& run : runs) {
    values.push_back(value_of(run, metric.key, options.online));
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
  mark_best(runs, groups, values, metric.better, cells);
  return cells;
}

/// The distinct protocols and each run's number among them; -1 for a run without scores.
struct Protocols {
  std::vector<std::string> texts;
  std::vector<int> of_run;
};

Protocols collect_protocols(std::span<const RunMetrics> runs, bool online) {
  Protocols result;
  for (const RunMetrics& run : runs) {
    const Json& scores = scores_of(run, online);
    if (scores.is_null()) {
      result.of_run.push_back(-1);
      continue;
    }
    const std::string text = protocol(scores, run.folder + "/metrics.json");
    const auto found = std::ranges::find(result.texts, text);
    result.of_run.push_back(static_cast<int>(found - result.texts.begin()));
    if (found == result.texts.end()) result.texts.push_back(text);
  }
  if (result.texts.empty() && online)
    throw InputError(fmt::format("none of the {} runs has online scores", runs.size()));
  return result;
}

/// Pairs, coverage, scale as ranges, as far as they are no columns.
std::string ranges_note(std::span<const RunMetrics> runs, const std::vector<Metric>& shown, bool online) {
  std::string note;
  for (const char* key : {"pairs", "coverage", "scale"}) {
    if (std::ranges::find(shown, key, &Metric::key) != shown.end()) continue;
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const RunMetrics& run : runs) {
      if (const auto value = value_of(run, key, online)) {
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

std::vector<std::string> notes_of(std::span<const RunMetrics> runs, const std::vector<Metric>& metrics,
                                  const Protocols& protocols, const TableOptions& options) {
  if (protocols.texts.empty()) return {"No run has scores: see final_unscored in each metrics.json."};
  std::vector<std::string> notes;
  notes.push_back(options.online ? "Online: each pose as estimated at the time it was made."
                                 : "Final: the trajectory as estimated after the whole sequence.");
  notes.back() += " ATE and RPE columns are root mean squares unless they say otherwise.";
  for (std::size_t i = 0; i < protocols.texts.size(); ++i) {
    const std::string number = protocols.texts.size() > 1 ? fmt::format(" {}", i + 1) : "";
    notes.push_back(fmt::format("Protocol{}: {}.", number, protocols.texts[i]));
  }
  if (const std::string ranges = ranges_note(runs, metrics, options.online); !ranges.empty()) notes.push_back(ranges);
  if (std::ranges::find(metrics, "realtime_factor", &Metric::key) != metrics.end()) {
    notes.push_back("Real-time factor: data time / processing time; above 1 is faster than real time.");
  }
  if (!std::ranges::all_of(runs, competes)) notes.push_back("Lost and failed runs do not compete for the best value.");
  return notes;
}

/// A column of texts.
void add_column(TextTable& table, const std::string& header, bool number, std::vector<Cell> cells) {
  table.columns.push_back({header, number});
  for (std::size_t i = 0; i < cells.size(); ++i) table.rows[i].push_back(std::move(cells[i]));
}

template <class Function>
std::vector<Cell> text_cells(std::size_t count, const Function& text) {
  std::vector<Cell> cells;
  for (std::size_t i = 0; i < count; ++i) cells.push_back({text(i)});
  return cells;
}

}  // namespace

std::string make_table(std::span<const RunMetrics> runs, const TableOptions& options) {
  const bool csv = options.format == TableFormat::csv;
  const Protocols protocols = collect_protocols(runs, options.online);
  const std::vector<Metric> metrics = choose_metrics(runs, options);
  const bool several = std::ranges::any_of(runs, [&](const auto& run) { return run.experiment != runs[0].experiment; });

  std::vector<Group> groups;
  for (std::size_t i = 0; i < runs.size(); ++i) groups.push_back({runs[i].experiment, protocols.of_run[i]});

  TextTable table;
  table.rows.resize(runs.size());
  if (several || csv) {
    add_column(table, "experiment", false, text_cells(runs.size(), [&](std::size_t i) { return runs[i].experiment; }));
  }
  add_column(table, csv ? "label" : "", false, text_cells(runs.size(), [&](std::size_t i) { return runs[i].label; }));
  for (const Metric& metric : metrics) {
    add_column(table, csv ? metric.key : metric.header, true, metric_cells(runs, groups, metric, options));
  }
  add_column(table, "status", false,
             text_cells(runs.size(), [&](std::size_t i) { return status_text(runs[i], options.format); }));
  if (csv || protocols.texts.size() > 1) {
    add_column(table, "protocol", false, text_cells(runs.size(), [&](std::size_t i) {
                 const int number = protocols.of_run[i];
                 if (number < 0) return std::string(csv ? "" : "-");
                 return csv ? protocols.texts[static_cast<std::size_t>(number)] : fmt::format("{}", number + 1);
               }));
  }
  if (!several) table.notes.push_back(fmt::format("Experiment: {}.", runs[0].experiment));
  const std::vector<std::string> notes = notes_of(runs, metrics, protocols, options);
  table.notes.insert(table.notes.end(), notes.begin(), notes.end());
  return format_table(table, options.format);
}

}  // namespace evbench
