#pragma once

#include <functional>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "core/support/json.hpp"
#include "eval/metric.hpp"
#include "eval/run_record.hpp"

namespace evbench {

/// The numbers of a run, of its final or its causal trajectory. Refers to the record, which must outlive it.
class RunNumbers {
 public:
  RunNumbers(const RunRecord& run, bool causal);

  const RunRecord& run() const { return *run_; }

  /// Null if the run has none.
  const Json& scores() const { return causal_ ? run_->causal_scores : run_->final_scores; }

  /// The number at a path like "ate.trans_m.rmse" in the scores, else in metrics.json or in "common"; none if it is
  /// missing.
  std::optional<double> at(const std::string& key) const;

  /// Whether the run was neither lost nor failed, and has scores if there is ground truth.
  bool succeeded() const;

  /// The cost of the run in a comparison of methods: the number, or 1 / number if higher is better; infinite for a run
  /// that did not succeed. None if it was not run, or succeeded without having the number. Precondition: lower or
  /// higher is better.
  std::optional<double> cost(const Metric& metric) const;

  /// The paths of all its numbers.
  std::set<std::string> keys() const;

 private:
  const Json* part(const std::string& name) const;

  const RunRecord* run_;
  bool causal_;
  Json others_;  ///< metrics.json without the scores
};

/// The numbers of all runs.
std::vector<RunNumbers> numbers_of(std::span<const RunRecord> runs, bool causal);

/// The paths of all numbers that any of the runs has.
std::vector<std::string> keys_of(const std::vector<RunNumbers>& runs);

/// The metrics of these keys. Throws InputError, with the nearest keys, for one that no run has.
std::vector<Metric> metrics_of(const std::vector<std::string>& keys, const std::vector<RunNumbers>& runs);

/// Whether any run has this number.
bool any_has(const std::vector<RunNumbers>& runs, const std::string& key);

/// The values of a metric for some runs, by index. For runs that did not succeed it is worse than all others: ∞ if
/// lower is better, −∞ if higher is. Runs without the number are left out.
std::vector<double> values_of(const std::vector<std::size_t>& indices, const std::vector<RunNumbers>& runs,
                              const Metric& metric);

/// Keeps one of the runs (by index) with the same place, e.g. the same seed: they are the same job in two folders.
/// Throws InputError if they are not.
void keep_one_of_each(std::vector<std::size_t>& indices, const std::vector<RunNumbers>& runs,
                      const std::function<std::string(std::size_t)>& place);

}  // namespace evbench
