#include "eval/comparison_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <optional>
#include <set>

#include "core/support/error.hpp"
#include "core/support/json.hpp"
#include "eval/holm.hpp"
#include "eval/methods.hpp"
#include "eval/paired_comparison.hpp"
#include "eval/run_columns.hpp"
#include "eval/table_notes.hpp"
#include "eval/table_text.hpp"

namespace evbench {
namespace {

using Cell = TextTable::Cell;

std::vector<Metric> compared_metrics(const ComparisonOptions& options, const std::vector<RunNumbers>& runs) {
  if (options.metrics.empty()) {
    std::vector<Metric> metrics;
    for (const char* key : {"ate.trans_m.rmse", "rpe.trans_m.rmse", "realtime_factor"}) {
      if (any_has(runs, key)) metrics.push_back(metric_of(key));
    }
    return metrics;
  }
  std::vector<Metric> metrics = metrics_of(options.metrics, runs);
  for (const Metric& metric : metrics) {
    if (metric.better != Better::neither) continue;
    throw InputError(
        fmt::format("\"{}\" can't be compared: neither lower nor higher is better; expected an error or a "
                    "time, e.g. ate.trans_m.rmse",
                    metric.key));
  }
  return metrics;
}

/// The SHA-256 of a run's observations; empty if it is not known.
std::string observations_of(const RunRecord& run) {
  std::ifstream file(run.folder + "/manifest.json");
  const Json manifest = try_parse_json(std::string(std::istreambuf_iterator<char>(file), {}));
  if (!manifest.is_object()) return "";
  const auto found = manifest.find("tracks_sha256");
  return found != manifest.end() && found->is_string() ? found->get<std::string>() : "";
}

std::string ratio_text(double ratio) {
  if (std::isinf(ratio)) return "inf";
  return fmt::format("{:.3g}", ratio);
}

/// Compares and writes row by row.
class Comparison {
 public:
  Comparison(std::span<const RunRecord> runs, const ComparisonOptions& options)
      : options_(options),
        csv_(options.format == TableFormat::csv),
        numbers_(numbers_of(runs, options.causal)),
        data_(number_data(numbers_, options.front_ends ? PairedBy::sequence : PairedBy::observations)),
        protocols_(collect_protocols(numbers_)),
        methods_(methods_of(numbers_, run_columns(runs), data_)) {
    if (methods_.size() < 2) {
      throw InputError(fmt::format("all runs {}are of one method; expected two or more to compare{}",
                                   options.front_ends ? "" : "with the same front-end ",
                                   options.front_ends ? "" : " (--front-ends compares front-ends, too)"));
    }
    base_ = options.base.empty() ? &methods_.front() : &find_method(methods_, options.base);
    metrics_ = compared_metrics(options, numbers_);
    const std::pair<const char*, std::size_t> names[] = {
        // and ranks
        {"", 0},      {"metric", 0},    {"pairs", 0}, {"failed", 2},  {"base failed", 3},
        {"ratio", 0}, {"better in", 4}, {"p", 5},     {"p, Holm", 0}, {"effect", 1}};
    for (const auto& [name, rank] : names) {
      table_.columns.push_back(
          {csv_ && *name == '\0' ? "method" : name, *name != '\0' && std::string(name) != "metric", rank});
    }
    if (csv_) table_.columns.insert(table_.columns.begin() + 6, {{"from", true}, {"to", true}});
  }

  std::string write() {
    for (const Metric& metric : metrics_) add_rows(metric);
    if (table_.rows.empty()) {
      throw InputError(
          fmt::format("no run is of the same data as one of \"{}\"; expected the same {}", base_->name, paired_by()));
    }
    add_notes();
    return format_table(table_, options_.format, options_.layout);
  }

 private:
  const char* paired_by() const { return options_.front_ends ? "source and seed" : "source, front-end and seed"; }

  void add_rows(const Metric& metric) {
    std::vector<const Method*> others;
    std::vector<PairedComparison> comparisons;
    std::size_t most_pairs = 0;
    const auto costs = [&](const Method& method) {
      return costs_of(method.runs, numbers_, metric, data_, protocols_.of_run);
    };
    for (const Method& method : methods_) {
      if (&method == base_) continue;
      const std::vector<CostPair> pairs = pair_up(costs(method), costs(*base_));
      if (pairs.empty()) continue;
      for (const CostPair& pair : pairs) paired_.insert({pair.own_run, pair.other_run});
      most_pairs = std::max(most_pairs, pairs.size());
      others.push_back(&method);
      comparisons.push_back(compare_pairs(pairs));
    }
    std::vector<double> p;
    for (const PairedComparison& comparison : comparisons) p.push_back(comparison.test.p);
    const std::vector<double> corrected = holm(p);
    if (!p.empty() && (!too_few_ || !too_few_->empty())) too_few_ = too_few_pairs(most_pairs, p.size());
    for (std::size_t i = 0; i < others.size(); ++i) add_row(metric, *others[i], comparisons[i], corrected[i]);
  }

  void add_row(const Metric& metric, const Method& method, const PairedComparison& c, double corrected) {
    const auto p_text = [&](double p) { return csv_ ? fmt::format("{}", p) : fmt::format("{:.2g}", p); };
    std::vector<Cell> row = {{method.name},
                             {csv_ ? metric.key : metric.header},
                             {fmt::format("{}", c.pairs)},
                             {fmt::format("{}", c.own_failed)},
                             {fmt::format("{}", c.other_failed)}};
    if (csv_) {
      for (const double value : {c.ratio, c.interval.from, c.interval.to}) row.push_back({fmt::format("{}", value)});
    } else {
      row.push_back({ratio_text(c.ratio), corrected < kSignificant && c.test.rank_biserial < 0.0,
                     fmt::format("[{}, {}]", ratio_text(c.interval.from), ratio_text(c.interval.to))});
    }
    row.push_back({fmt::format("{}", c.better)});
    row.push_back({p_text(c.test.p)});
    row.push_back({p_text(corrected)});
    row.push_back({csv_ ? fmt::format("{}", c.test.rank_biserial) : fmt::format("{:.2f}", c.test.rank_biserial)});
    table_.rows.push_back(std::move(row));
  }

  void add_notes() {
    table_.experiments = {fmt::format("compared with {}", base_->name)};
    std::vector<std::string>& notes = table_.notes;
    notes.push_back(fmt::format("Compared with: {}. Pairs are runs of the same {}.", base_->name, paired_by()));
    std::size_t identical = 0, known = 0;
    for (const auto& [own, other] : paired_) {
      const std::string a = observations_of(numbers_[own].run()), b = observations_of(numbers_[other].run());
      known += !a.empty() && !b.empty() ? 1 : 0;
      identical += !a.empty() && a == b ? 1 : 0;
    }
    notes.push_back(
        fmt::format("Observations were identical in {} of {} pairs{}.", identical, paired_.size(),
                    known < paired_.size() ? fmt::format(" (not known of {})", paired_.size() - known) : ""));
    notes.emplace_back(
        "Ratio: median of own / base (where higher is better, of base / own) with its 95 % interval (bootstrap); below "
        "1 "
        "the method is better. A failed run is infinitely worse than any other, two failed ones are equal.");
    notes.push_back(fmt::format("p: Wilcoxon's signed-rank test, two-sided; Holm: corrected for the comparisons of a "
                                "metric. {}: better with p < {} after correction. Effect: matched-pairs rank-biserial "
                                "correlation, -1: better in all pairs.",
                                mark_name(options_.format), kSignificant) +
                    too_few_.value_or(""));
    for (const std::string& protocol : protocols_.texts) notes.push_back(fmt::format("Protocol: {}.", protocol));
  }

  const ComparisonOptions& options_;
  bool csv_;
  std::vector<RunNumbers> numbers_;
  std::vector<std::size_t> data_;
  Protocols protocols_;
  std::vector<Method> methods_;
  const Method* base_ = nullptr;
  std::vector<Metric> metrics_;
  std::optional<std::string> too_few_;                    ///< note if all metrics have too few pairs; empty: they don't
  std::set<std::pair<std::size_t, std::size_t>> paired_;  ///< own and base's run of each pair of any metric
  TextTable table_;
};

}  // namespace

std::string make_comparison_table(std::span<const RunRecord> runs, const ComparisonOptions& options) {
  return Comparison(runs, options).write();
}

}  // namespace evbench
