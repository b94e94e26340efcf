#include "eval/table_notes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "core/support/error.hpp"
#include "eval/protocol.hpp"

namespace evbench {
namespace {

constexpr std::size_t kMostTroubles = 20;  // a table of thousands of runs has many

/// Pairs, coverage and scale as ranges, if they are not columns.
std::string ranges_note(const std::vector<RunNumbers>& runs, const std::vector<Metric>& shown) {
  std::string note;
  for (const char* key : {"pairs", "coverage", "scale"}) {
    if (std::ranges::find(shown, key, &Metric::key) != shown.end()) continue;
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const RunNumbers& run : runs) {
      if (const auto value = run.at(key)) {
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

/// A failure of a run and its reason.
struct Trouble {
  std::string what, reason;
  bool operator==(const Trouble&) const = default;
};

/// None if a run was neither lost nor is without scores. The reason of its status is the most informative.
std::optional<Trouble> trouble_of(const RunNumbers& numbers, bool causal) {
  const RunRecord& run = numbers.run();
  if (!run.damage.empty()) return Trouble{"Damaged", run.damage};
  if (!run.done) return Trouble{"Not run yet", ""};
  const std::string reason = run.competes() ? "" : run.status->status.reason;
  const bool scored = !numbers.scores().is_null();
  const bool degraded = run.status && run.status->status.state == RunState::degraded;
  if (scored && degraded) return Trouble{"Degraded", run.status->status.reason};
  if (scored && run.competes()) return std::nullopt;
  const std::string& unscored = causal ? run.causal_unscored : run.final_unscored;
  const std::string what = !scored ? "Without scores" : run.status->status.state == RunState::lost ? "Lost" : "Failed";
  return Trouble{what, !reason.empty() ? reason : !unscored.empty() ? unscored : "not known"};
}

/// A note for each kind of trouble, with its runs.
std::vector<std::string> trouble_notes(const std::vector<RunNumbers>& runs, const std::vector<std::string>& names,
                                       bool causal) {
  std::vector<std::pair<Trouble, std::string>> troubles;
  std::size_t listed = 0, unlisted = 0;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    const std::optional<Trouble> trouble = trouble_of(runs[i], causal);
    if (!trouble) continue;
    if (listed == kMostTroubles) {
      ++unlisted;
      continue;
    }
    ++listed;
    const auto found = std::ranges::find(troubles, *trouble, &std::pair<Trouble, std::string>::first);
    if (found == troubles.end()) {
      troubles.emplace_back(*trouble, names[i]);
    } else {
      found->second += "; " + names[i];
    }
  }
  std::vector<std::string> notes;
  for (const auto& [trouble, who] : troubles) {
    notes.push_back(fmt::format("{}: {}{}{}.", trouble.what, who, trouble.reason.empty() ? "" : ": ", trouble.reason));
  }
  if (unlisted > 0) {
    notes.push_back(
        fmt::format("{} more runs were degraded, lost, failed or not run: --format csv lists them all.", unlisted));
  }
  return notes;
}

/// The common time of runs of the same data.
std::vector<std::string> common_time_notes(const std::vector<RunNumbers>& runs) {
  std::vector<std::string> spans;
  for (const RunNumbers& run : runs) {
    if (run.run().common_scores.is_null()) continue;
    const Json& range = run.run().common_scores.at("association").at("time_range_s");
    std::string span = fmt::format("{:.2f} to {:.2f} s", range.at(0).get<double>(), range.at(1).get<double>());
    if (std::ranges::find(spans, span) == spans.end()) spans.push_back(std::move(span));
  }
  if (spans.empty()) return {};
  const std::string span = spans.size() == 1 ? spans.front() + "," : "for each seed and sequence the time";
  return {fmt::format("Common time: {} covered by all runs that were not lost.", span)};
}

/// The covered part of the sequence, if it is not most of it: of the scored poses, or without ground truth of the
/// trajectory's own poses.
std::string missing_text(const RunNumbers& numbers) {
  constexpr double kMost = 0.9, kSoon = 1.0;  // [s]
  const RunRecord& run = numbers.run();
  const RunStatus& status = *run.status;
  std::optional<TimeRange> span;
  if (status.scored > 0 && status.scored <= status.segments.size()) {
    span = TimeRange{status.segments[status.scored - 1].from, status.segments[status.scored - 1].to};
  }
  std::optional<double> covered = numbers.at("coverage");
  if (const Json scored = numbers.scores().is_object() ? numbers.scores().value("span_s", Json()) : Json();
      scored.is_array() && scored.size() == 2) {
    span = TimeRange{scored[0].get<double>(), scored[1].get<double>()};
  }
  const bool known = run.range && std::isfinite(run.range->from) && run.range->to > run.range->from;
  if (!covered && span && known) covered = (span->to - span->from) / (run.range->to - run.range->from);
  std::string text;
  if (covered && *covered < kMost) text = fmt::format(", covers {:.0f} %", 100.0 * *covered);
  if (span && known && span->from - run.range->from > kSoon) {
    text += fmt::format("{} from {:.2f} s", text.empty() ? "," : "", span->from);
  }
  return text;
}

}  // namespace

Protocols collect_protocols(const std::vector<RunNumbers>& runs) {
  Protocols result;
  for (const RunNumbers& run : runs) {
    if (run.scores().is_null()) {
      result.of_run.push_back(-1);
      continue;
    }
    std::string text = protocol(run.scores(), run.run().folder + "/metrics.json");
    const auto found = std::ranges::find(result.texts, text);
    result.of_run.push_back(static_cast<int>(found - result.texts.begin()));
    if (found == result.texts.end()) result.texts.push_back(std::move(text));
  }
  return result;
}

std::vector<std::string> table_notes(const std::vector<RunNumbers>& runs, const std::vector<std::string>& names,
                                     const std::vector<Metric>& metrics, const Protocols& protocols,
                                     const TableOptions& options) {
  const auto shown = [&](const char* key) { return std::ranges::find(metrics, key, &Metric::key) != metrics.end(); };
  std::vector<std::string> notes;
  if (protocols.texts.empty()) {
    notes.emplace_back("No run has scores.");
  } else {
    const bool of_runs = std::ranges::any_of(runs, [](const RunNumbers& run) { return run.run().status.has_value(); });
    notes.emplace_back(options.causal ? "Causal: each pose as estimated at the time it was made. "
                       : of_runs      ? "Final: the trajectory as estimated after the whole sequence. "
                                      : "");
    notes.back() += "ATE and RPE columns are root mean squares unless they say otherwise.";
  }
  for (std::size_t i = 0; i < protocols.texts.size(); ++i) {
    const std::string number = protocols.texts.size() > 1 ? fmt::format(" {}", i + 1) : "";
    notes.push_back(fmt::format("Protocol{}: {}.", number, protocols.texts[i]));
  }
  if (const std::string ranges = ranges_note(runs, metrics); !ranges.empty()) notes.push_back(ranges);
  if (std::ranges::any_of(metrics, [](const Metric& metric) { return metric.key.starts_with("common."); })) {
    std::ranges::move(common_time_notes(runs), std::back_inserter(notes));
  }
  const auto is_velocity = [](const Metric& metric) { return metric.key.find("velocity.") != std::string::npos; };
  if (std::ranges::any_of(metrics, is_velocity)) {
    notes.emplace_back(
        "Velocity AUC: area under the share of times, weighted by speed, at which the relative error of the velocity "
        "in "
        "the camera's frame is below 0 to 1, at the scale of the alignment; the back-end's own velocity, or the "
        "differentiated poses where it has none.");
  }
  if (shown("realtime_factor")) {
    notes.push_back(
        fmt::format("{}: data time / processing time (front-end and back-end); above 1 is faster than real time.",
                    options.format == TableFormat::latex ? "RTF, the real-time factor" : "Real-time factor"));
  }
  if (options.format != TableFormat::latex) {
    std::ranges::move(trouble_notes(runs, names, options.causal), std::back_inserter(notes));
  }
  return notes;
}

std::string status_text(const RunNumbers& numbers) {
  constexpr std::size_t kShort = 40;
  const RunRecord& run = numbers.run();
  const std::string word = status_word(run);
  if (!run.done || !run.status) return word.empty() ? "-" : word;
  if (run.status->status.state == RunState::ok) return word + missing_text(numbers);
  const Status& status = run.status->status;
  if (run.status->complete) return fmt::format("{} at {:.2f} s", word, status.time);
  return status.reason.size() <= kShort ? status.reason : word;  // it broke off: no time in the data
}

std::string status_word(const RunRecord& run) {
  if (!run.damage.empty()) return "damaged";
  if (!run.done) return "not run";
  return run.status ? to_string(run.status->status.state) : "";
}

std::string status_reason(const RunRecord& run) {
  return !run.damage.empty() ? run.damage : run.status ? run.status->status.reason : "";
}

}  // namespace evbench
