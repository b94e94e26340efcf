#include "eval/run_numbers.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <map>
#include <string_view>

#include "core/support/error.hpp"
#include "core/support/nearest.hpp"

namespace evbench {
namespace {

/// The number at a path like "ate.trans_m.rmse"; none if it is missing.
std::optional<double> number_at(const Json& root, std::string_view key) {
  const Json* node = &root;
  for (std::size_t at = 0; at <= key.size();) {
    const std::size_t stop = std::min(key.find('.', at), key.size());
    if (!node->is_object()) return std::nullopt;
    const auto found = node->find(std::string(key.substr(at, stop - at)));
    if (found == node->end()) return std::nullopt;
    node = &*found;
    at = stop + 1;
  }
  return node->is_number() ? std::optional(node->get<double>()) : std::nullopt;
}

/// The paths of all numbers in a JSON object.
void list_numbers(const Json& node, const std::string& prefix, std::set<std::string>& keys) {
  if (!node.is_object()) return;
  for (const auto& [key, value] : node.items()) {
    if (value.is_number()) keys.insert(prefix + key);
    list_numbers(value, prefix + key + ".", keys);
  }
}

/// Keys that runs have, first those that are columns of tables.
std::vector<std::string> suggested_keys(const std::vector<RunNumbers>& runs) {
  std::vector<std::string> keys = keys_of(runs);
  const auto place = [](const std::string& key) { return std::ranges::find(known_metrics(), key, &Metric::key); };
  std::ranges::stable_sort(keys, {}, place);
  return keys;
}

constexpr const char* kParts[] = {"final", "causal", "covariance", "common"};

}  // namespace

RunNumbers::RunNumbers(const RunRecord& run, bool causal)
    : run_(&run), causal_(causal), others_(to_json_without_scores(run)) {}

const Json* RunNumbers::part(const std::string& name) const {
  if (name == "final") return &run_->final_scores;
  if (name == "causal") return &run_->causal_scores;
  if (name == "covariance") return &run_->covariance;
  return name == "common" ? &run_->common_scores : nullptr;
}

std::optional<double> RunNumbers::at(const std::string& key) const {
  if (const std::optional<double> score = number_at(scores(), key)) return score;
  const std::size_t dot = std::min(key.find('.'), key.size());
  if (const Json* json = part(key.substr(0, dot))) {
    return dot == key.size() ? std::nullopt : number_at(*json, std::string_view(key).substr(dot + 1));
  }
  return number_at(others_, key);
}

bool RunNumbers::succeeded() const {
  const std::string& unscored = causal_ ? run_->causal_unscored : run_->final_unscored;
  return run_->competes() && (!scores().is_null() || unscored == kNoGroundTruth);
}

std::optional<double> RunNumbers::cost(const Metric& metric) const {
  if (!run_->done) return std::nullopt;
  if (!run_->competes()) return std::numeric_limits<double>::infinity();
  if (const std::optional<double> value = at(metric.key)) {
    return metric.better == Better::higher ? 1.0 / *value : *value;
  }
  return succeeded() ? std::nullopt : std::optional(std::numeric_limits<double>::infinity());
}

std::set<std::string> RunNumbers::keys() const {
  std::set<std::string> keys;
  list_numbers(scores(), "", keys);
  for (const char* name : kParts) {
    if (part(name) != &scores()) list_numbers(*part(name), std::string(name) + ".", keys);
  }
  list_numbers(others_, "", keys);
  return keys;
}

std::vector<RunNumbers> numbers_of(std::span<const RunRecord> runs, bool causal) {
  std::vector<RunNumbers> numbers;
  for (const RunRecord& run : runs) numbers.emplace_back(run, causal);
  return numbers;
}

bool any_has(const std::vector<RunNumbers>& runs, const std::string& key) {
  return std::ranges::any_of(runs, [&](const RunNumbers& run) { return run.at(key).has_value(); });
}

std::vector<std::string> keys_of(const std::vector<RunNumbers>& runs) {
  std::set<std::string> keys;
  for (const RunNumbers& run : runs) keys.merge(run.keys());
  return {keys.begin(), keys.end()};
}

std::vector<Metric> metrics_of(const std::vector<std::string>& keys, const std::vector<RunNumbers>& runs) {
  std::vector<Metric> metrics;
  for (const std::string& key : keys) {
    if (!any_has(runs, key)) {
      const bool known = std::ranges::find(known_metrics(), key, &Metric::key) != known_metrics().end();
      throw InputError(fmt::format("no run has the metric \"{}\"{} (evbench table --list-metrics has them all{})", key,
                                   suggestion(key, suggested_keys(runs)),
                                   known ? "; evbench score adds what an older version did not compute" : ""));
    }
    metrics.push_back(metric_of(key));
  }
  return metrics;
}

std::vector<double> values_of(const std::vector<std::size_t>& indices, const std::vector<RunNumbers>& runs,
                              const Metric& metric) {
  const double worst = std::numeric_limits<double>::infinity() * (metric.better == Better::higher ? -1.0 : 1.0);
  std::vector<double> values;
  for (const std::size_t i : indices) {
    const RunNumbers& run = runs[i];
    if (!run.run().done) continue;
    const std::optional<double> value = run.at(metric.key);
    if (metric.better != Better::neither && !run.succeeded()) {
      values.push_back(worst);
    } else if (value) {
      values.push_back(*value);
    }
  }
  return values;
}

void keep_one_of_each(std::vector<std::size_t>& indices, const std::vector<RunNumbers>& runs,
                      const std::function<std::string(std::size_t)>& place) {
  std::map<std::string, std::size_t> known;
  std::erase_if(indices, [&](std::size_t i) {
    const auto [found, is_new] = known.try_emplace(place(i), i);
    const RunRecord &first = runs[found->second].run(), &run = runs[i].run();
    if (is_new || (!run.key.empty() && first.key == run.key)) return !is_new;
    throw InputError(
        fmt::format("{} and {} are both \"{}\"{}, and not the same job; expected one run of each, e.g. of "
                    "one version of the program: by --only, or the newest of each label and config without --all",
                    first.folder, run.folder, run.label, run.seed ? fmt::format(", seed {}", *run.seed) : ""));
  });
}

}  // namespace evbench
