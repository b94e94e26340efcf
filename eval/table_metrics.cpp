#include "eval/table_metrics.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "core/support/error.hpp"
#include "core/support/nearest.hpp"

namespace evbench {
namespace {

const std::vector<Metric>& known_metrics() {
  static const std::vector<Metric> metrics = {
      {"ate.trans_m.rmse", "ATE [m]", Better::lower, {}, 1.0, Shown::in_print},
      {"ate.trans_percent", "ATE [% of path]", Better::lower},
      {"ate.rot_deg.rmse", "ATE [deg]", Better::lower, {}, 1.0, Shown::in_print},
      {"rpe.trans_m.rmse", "RPE [m]", Better::lower, {}, 1.0, Shown::in_print},
      {"rpe.rot_deg.rmse", "RPE [deg]", Better::lower, {}, 1.0, Shown::in_print},
      {"common.ate.trans_m.rmse", "ATE, common time [m]", Better::lower},
      {"common.ate.rot_deg.rmse", "ATE, common time [deg]", Better::lower, {}, 1.0, Shown::on_request},
      {"common.rpe.trans_m.rmse", "RPE, common time [m]", Better::lower},
      {"common.rpe.rot_deg.rmse", "RPE, common time [deg]", Better::lower, {}, 1.0, Shown::on_request},
      {"delay_s.median", "delay [s]", Better::neither, 3},
      {"delay_s.max", "largest delay [s]", Better::neither, 3, 1.0, Shown::on_request},
      {"zero_latency.ate.trans_m.rmse", "ATE at zero latency [m]", Better::lower},
      {"zero_latency.ate.rot_deg.rmse", "ATE at zero latency [deg]", Better::lower, {}, 1.0, Shown::on_request},
      {"zero_latency.rpe.trans_m.rmse", "RPE at zero latency [m]", Better::lower},
      {"zero_latency.rpe.rot_deg.rmse", "RPE at zero latency [deg]", Better::lower, {}, 1.0, Shown::on_request},
      {"equal_latency.ate.trans_m.rmse", "ATE at equal latency [m]", Better::lower},
      {"equal_latency.ate.rot_deg.rmse", "ATE at equal latency [deg]", Better::lower, {}, 1.0, Shown::on_request},
      {"equal_latency.rpe.trans_m.rmse", "RPE at equal latency [m]", Better::lower},
      {"equal_latency.rpe.rot_deg.rmse", "RPE at equal latency [deg]", Better::lower, {}, 1.0, Shown::on_request},
      {"covariance.newest.nees", "NEES, newest pose", Better::neither, {}, 1.0, Shown::on_request},
      {"covariance.over_100ms.nees", "NEES over 0.1 s", Better::neither, {}, 1.0, Shown::on_request},
      {"covariance.over_1s.nees", "NEES over 1 s", Better::neither, {}, 1.0, Shown::on_request},
      {"segments.trans_percent.mean", "segments [%]", Better::lower, {}, 1.0, Shown::in_print},
      {"segments.rot_deg_per_m.mean", "segments [deg/m]", Better::lower, {}, 1.0, Shown::in_print},
      {"pairs", "pairs", Better::neither, 0},
      {"coverage", "covered [%]", Better::neither, 1, 100.0},
      {"scale", "scale", Better::neither, 4},
      {"times.source_s", "source [s]", Better::neither, 3, 1.0, Shown::on_request},
      {"times.frontend_s", "front-end [s]", Better::neither, 3},
      {"times.backend_s", "back-end [s]", Better::lower, 3},
      {"times.waiting_s", "waiting [s]", Better::neither, 3},
      {"realtime_factor", "real-time factor", Better::higher, {}, 1.0, Shown::in_print},
  };
  return metrics;
}

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

}  // namespace

Metric metric_of(const std::string& key) {
  for (const std::string of : {"final", "online"}) {  // the scores of the trajectory that the table isn't of
    if (!key.starts_with(of + ".")) continue;
    Metric metric = metric_of(key.substr(of.size() + 1));
    metric.header = metric.header == metric.key ? key : of + " " + metric.header;
    metric.key = key;
    return metric;
  }
  const auto found = std::ranges::find(known_metrics(), key, &Metric::key);
  if (found != known_metrics().end()) return *found;
  const bool error =
      (key.starts_with("ate.") || key.starts_with("rpe.") || key.starts_with("segments.")) && !key.ends_with(".n");
  const bool cost = key == "runtime_s" || key == "peak_rss_mib" || key.starts_with("times.");
  return {key, key, error || cost ? Better::lower : Better::neither};
}

const Json& scores_of(const Row& row, bool online) { return online ? row.run->online_scores : row.run->final_scores; }

std::optional<double> value_of(const Row& row, const std::string& key, bool online) {
  const std::optional<double> score = number_at(scores_of(row, online), key);
  return score ? score : number_at(row.metrics, key);
}

std::vector<Metric> choose_metrics(const Rows& rows, const TableOptions& options) {
  const auto present = [&](const std::string& key) {
    return std::ranges::any_of(rows, [&](const Row& row) { return value_of(row, key, options.online).has_value(); });
  };
  std::vector<Metric> metrics;
  for (const std::string& key : options.metrics) {
    if (!present(key)) fail_unknown(rows, key, options.online);
    metrics.push_back(metric_of(key));
  }
  const bool print = options.format == TableFormat::latex;
  const auto waited = [](const Row& row) { return row.run->times && row.run->times->waiting > 0.0; };
  for (const Metric& metric : known_metrics()) {
    if (metric.key == "times.waiting_s" && std::ranges::none_of(rows, waited)) continue;  // all ran in one thread
    const bool protocol_value = metric.key == "pairs" || metric.key == "coverage" || metric.key == "scale";
    const bool usual = metric.shown <= (print ? Shown::in_print : Shown::on_screen);
    const bool wanted =
        (options.metrics.empty() && usual) || (options.format == TableFormat::csv && protocol_value &&
                                               std::ranges::find(options.metrics, metric.key) == options.metrics.end());
    if (wanted && present(metric.key)) metrics.push_back(metric);
  }
  return metrics;
}

}  // namespace evbench
