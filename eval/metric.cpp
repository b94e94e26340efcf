#include "eval/metric.hpp"

#include <algorithm>

#include "eval/old_names.hpp"

namespace evbench {
namespace {

constexpr ShownIn kAll{true, true, true}, kScreen{false, true, true}, kRowARun{false, true, false},
    kSummary{false, false, true}, kOnRequest{};

}  // namespace

const std::vector<Metric>& known_metrics() {
  static const std::vector<Metric> metrics = {
      {"ate.trans_m.rmse", "ATE [m]", Better::lower, kAll},
      {"ate.trans_percent", "ATE [% of path]", Better::lower, kRowARun},
      {"ate.rot_deg.rmse", "ATE [deg]", Better::lower, kScreen},
      {"ate.rot_centred_deg.rmse", "ATE, centred [deg]", Better::lower, kOnRequest},
      {"rpe.trans_m.rmse", "RPE [m]", Better::lower, kAll},
      {"rpe.rot_deg.rmse", "RPE [deg]", Better::lower, kAll},
      {"mpe_percent", "MPE [% of path]", Better::lower, kOnRequest},
      {"mre_deg_per_m", "MRE [deg/m]", Better::lower, kOnRequest},
      {"mye_deg_per_m", "MYE [deg/m]", Better::lower, kOnRequest},
      {"velocity.rve.auc", "velocity AUC", Better::higher, kScreen, 3},
      {"velocity.rve.median", "RVE, median", Better::lower, kOnRequest},
      {"velocity.angular.auc", "angular velocity AUC", Better::higher, kOnRequest, 3},
      {"velocity.angular.median", "angular RVE, median", Better::lower, kOnRequest},
      {"velocity.differentiated.rve.auc", "velocity AUC, differentiated", Better::higher, kOnRequest, 3},
      {"velocity.differentiated.rve.median", "RVE, differentiated, median", Better::lower, kOnRequest},
      {"velocity.differentiated.angular.auc", "angular velocity AUC, differentiated", Better::higher, kOnRequest, 3},
      {"velocity.differentiated.angular.median", "angular RVE, differentiated, median", Better::lower, kOnRequest},
      {"common.ate.trans_m.rmse", "ATE, common time [m]", Better::lower, kScreen},
      {"common.ate.rot_deg.rmse", "ATE, common time [deg]", Better::lower, kOnRequest},
      {"common.rpe.trans_m.rmse", "RPE, common time [m]", Better::lower, kScreen},
      {"common.rpe.rot_deg.rmse", "RPE, common time [deg]", Better::lower, kOnRequest},
      {"delay_s.median", "delay [s]", Better::neither, kRowARun, 3},
      {"delay_s.max", "largest delay [s]", Better::neither, kOnRequest, 3},
      {"zero_latency.ate.trans_m.rmse", "ATE at zero latency [m]", Better::lower, kScreen},
      {"zero_latency.ate.rot_deg.rmse", "ATE at zero latency [deg]", Better::lower, kOnRequest},
      {"zero_latency.rpe.trans_m.rmse", "RPE at zero latency [m]", Better::lower, kScreen},
      {"zero_latency.rpe.rot_deg.rmse", "RPE at zero latency [deg]", Better::lower, kOnRequest},
      {"equal_latency.ate.trans_m.rmse", "ATE at equal latency [m]", Better::lower, kScreen},
      {"equal_latency.ate.rot_deg.rmse", "ATE at equal latency [deg]", Better::lower, kOnRequest},
      {"equal_latency.rpe.trans_m.rmse", "RPE at equal latency [m]", Better::lower, kScreen},
      {"equal_latency.rpe.rot_deg.rmse", "RPE at equal latency [deg]", Better::lower, kOnRequest},
      {"common.zero_latency.ate.trans_m.rmse", "ATE at zero latency, common time [m]", Better::lower, kScreen},
      {"common.zero_latency.rpe.trans_m.rmse", "RPE at zero latency, common time [m]", Better::lower, kScreen},
      {"common.equal_latency.ate.trans_m.rmse", "ATE at equal latency, common time [m]", Better::lower, kScreen},
      {"common.equal_latency.rpe.trans_m.rmse", "RPE at equal latency, common time [m]", Better::lower, kScreen},
      {"common.zero_latency.ate.rot_deg.rmse", "ATE at zero latency, common time [deg]", Better::lower, kOnRequest},
      {"common.zero_latency.rpe.rot_deg.rmse", "RPE at zero latency, common time [deg]", Better::lower, kOnRequest},
      {"common.equal_latency.ate.rot_deg.rmse", "ATE at equal latency, common time [deg]", Better::lower, kOnRequest},
      {"common.equal_latency.rpe.rot_deg.rmse", "RPE at equal latency, common time [deg]", Better::lower, kOnRequest},
      {"covariance.newest.nees", "NEES, newest pose", Better::neither, kOnRequest},
      {"covariance.over_100ms.nees", "NEES over 0.1 s", Better::neither, kOnRequest},
      {"covariance.over_1s.nees", "NEES over 1 s", Better::neither, kOnRequest},
      {"segments.trans_percent.mean", "segments [%]", Better::lower, kAll},
      {"segments.rot_deg_per_m.mean", "segments [deg/m]", Better::lower, kAll},
      {"pairs", "pairs", Better::neither, kRowARun, 0},
      {"coverage", "covered [%]", Better::neither, kScreen, 1, 100.0, "cov. [%]"},
      {"scale", "scale", Better::neither, kRowARun, 4},
      {"tracks.pieces", "pieces of tracks", Better::neither, kOnRequest, 0},
      {"tracks.life_s.median", "life of tracks [s]", Better::higher, kOnRequest},
      {"tracks.error_px.at_100ms.median", "track error at 0.1 s [px]", Better::lower, kOnRequest},
      {"tracks.error_px.at_500ms.median", "track error at 0.5 s [px]", Better::lower, kOnRequest},
      {"tracks.error_px.at_1s.median", "track error at 1 s [px]", Better::lower, kOnRequest},
      {"tracks.drifting", "drifting tracks [%]", Better::lower, kOnRequest, 1, 100.0},
      {"tracks.beyond_3px", "observations beyond 3 px [%]", Better::lower, kOnRequest, 1, 100.0},
      {"tracks.reassociated.right", "re-associated rightly", Better::neither, kOnRequest, 0},
      {"tracks.reassociated.wrong", "re-associated wrongly", Better::lower, kOnRequest, 0},
      {"times.source_s", "source [s]", Better::neither, kOnRequest, 3},
      {"times.frontend_s", "front-end [s]", Better::neither, kScreen, 3},
      {"times.backend_s", "back-end [s]", Better::lower, kScreen, 3},
      {"times.waiting_s", "waiting [s]", Better::neither, kRowARun, 3},
      {"times.slowest_5s_factor", "real-time factor, slowest 5 s", Better::higher, kOnRequest},
      {"times.frontend_ms.median", "front-end, batch [ms]", Better::neither, kSummary},
      {"times.frontend_ms.p99", "front-end, batch, p99 [ms]", Better::neither, kOnRequest},
      {"times.frontend_ms.max", "front-end, batch, max [ms]", Better::neither, kOnRequest},
      {"times.backend_ms.median", "update [ms]", Better::lower, kSummary},
      {"times.backend_ms.p99", "update, p99 [ms]", Better::lower, kSummary},
      {"times.backend_ms.max", "update, max [ms]", Better::lower, kSummary},
      {"runtime_s", "processing [s]", Better::lower, kOnRequest, 3},
      {"realtime_factor", "real-time factor", Better::higher, kAll, {}, 1.0, "RTF"},
      {"peak_rss_mib", "memory [MiB]", Better::lower, kSummary, 1},
  };
  return metrics;
}

Metric metric_of(const std::string& name) {
  const std::string key = present_metric(name);
  for (const std::string of : {"final", "causal"}) {  // the scores of the other trajectory
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
  return {key, key, error || key.starts_with("times.") ? Better::lower : Better::neither, kOnRequest};
}

}  // namespace evbench
