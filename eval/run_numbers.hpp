#pragma once

#include <functional>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "eval/metric.hpp"
#include "eval/run_record.hpp"
#include "core/support/json.hpp"

namespace evbench {

/// The numbers of a run, of its final or its causal trajectory. Refers to the record, which must outlive it.
class RunNumbers {
 public:
  RunNumbers(const RunRecord& run, bool causal);

  const RunRecord& run() const { return *run_; }

  /// null where the run has none.
  const Json& scores() const { return online_ ? run_->causal_scores : run_->final_scores; }

  /// The number at a path like "ate.trans_m.rmse" of the scores, or else of all that metrics.json has, and of "common",
  /// if there is one.
  std::optional<double> at(const std::string& key) const;

  /// Did the run do what it was to do? It was neither lost nor did it fail, and has scores, where there is ground
  /// truth.
  bool succeeded() const;

  /// What the run counts for where methods are compared by their cost: the number, or 1 / number where higher is
  /// better; infinite for a run that did not succeed. None where it was not run, and where it succeeded but such a
  /// number was not taken down. Precondition: lower or higher is better.
  std::optional<double> cost(const Metric& metric) const;

  /// The paths of all that are there.
  std::set<std::string> keys() const;

 private:
  const Json* part(const std::string& name) const;

  const RunRecord* run_;
  bool online_;
  Json others_;  ///< metrics.json without the scores
};

/// Of all runs.
std::vector<RunNumbers> numbers_of(std::span<const RunRecord> runs, bool causal);

/// The paths of all that any of the runs has.
std::vector<std::string> keys_of(const std::vector<RunNumbers>& runs);

/// The metrics of these keys; throws InputError, with the nearest keys, for one that no run has.
std::vector<Metric> metrics_of(const std::vector<std::string>& keys, const std::vector<RunNumbers>& runs);

/// Does any run have this number?
bool any_has(const std::vector<RunNumbers>& runs, const std::string& key);

/// What some runs, by their indices, say of a metric. Of those that did not succeed it is worse than of all others
/// where lower or higher is better: infinite, or −infinite. Runs without such a number are left out.
std::vector<double> values_of(const std::vector<std::size_t>& indices, const std::vector<RunNumbers>& runs,
                              const Metric& metric);

/// Of runs (by their indices) that have the same place, say the same seed, one is kept: they are the same job, found in
/// two folders. Throws InputError where they are not.
void keep_one_of_each(std::vector<std::size_t>& indices, const std::vector<RunNumbers>& runs,
                      const std::function<std::string(std::size_t)>& place);

}  // namespace evbench
