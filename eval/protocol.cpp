#include "eval/protocol.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "core/support/json.hpp"
#include "core/support/json_reason.hpp"

namespace evbench {
namespace {

std::string range_text(const Json& range) {
  const Json& from = range.at(0);
  const Json& to = range.at(1);
  if (from.is_null()) return fmt::format("up to {} s", to.get<double>());
  if (to.is_null()) return fmt::format("from {} s", from.get<double>());
  return fmt::format("{} to {} s", from.get<double>(), to.get<double>());
}

/// "deio: ", or "custom (deio but align_first): " if options differ; empty without a protocol.
std::string name_text(const Json& scores) {
  const Json protocol = scores.value("protocol", Json());
  if (!protocol.is_object()) return "";
  const auto name = protocol.at("name").get<std::string>();
  const auto custom = protocol.at("custom").get<std::vector<std::string>>();
  return custom.empty() ? name + ": " : fmt::format("custom ({} but {}): ", name, fmt::join(custom, ", "));
}

std::string alignment_text(const Json& alignment) {
  const auto method = alignment.at("method").get<std::string>();
  if (method == "none") return "no alignment";
  std::string text = method + " alignment";
  if (method == "se3") text = "SE(3) alignment";
  if (method == "sim3") text = "Sim(3) alignment";
  if (method == "scale") text = "scale alignment only";
  if (method == "yaw") text = "yaw and translation alignment";
  if (method == "origin") return "first poses made equal";
  if (const Json& first = alignment.at("first"); !first.is_null())
    return text + fmt::format(" on the first {} poses", dump_json(first));
  if (const Json& range = alignment.at("range_s"); !range.is_null()) {
    return text + " on the poses " + range_text(range);
  }
  if (const Json seconds = alignment.value("seconds", Json()); !seconds.is_null()) {
    return text + " on the poses " + range_text(seconds) + " after the first";
  }
  return text + " on all poses";
}

std::string association_text(const Json& association) {
  const bool nearest = association.at("mode") == "nearest";
  std::string text = fmt::format("{} ground truth within {} s", nearest ? "nearest" : "interpolated",
                                 association.at("tolerance_s").get<double>());
  if (const double offset = association.at("time_offset_s").get<double>(); offset != 0.0) {
    text += fmt::format(", estimate's times {:+} s", offset);
  }
  if (const Json& range = association.at("time_range_s"); !range.is_null()) {
    text += ", only " + range_text(range);
  }
  return text;
}

std::string relative_text(const Json& rpe) {
  const auto unit = rpe.at("delta_unit").get<std::string>();
  const bool all = rpe.at("pairing") == "all";
  const double delta = rpe.at("delta").get<double>();
  const std::string shown_unit = delta == 1.0 ? unit.substr(0, unit.size() - 1) : unit;
  std::string text = fmt::format("RPE over {} {}, {} pairs", delta, shown_unit, all ? "all" : "consecutive");
  if (unit == "seconds" || (all && unit != "frames")) {
    text += fmt::format(" (delta within {:g} %)", 100.0 * rpe.at("tolerance").get<double>());
  }
  if (unit == "metres" || unit == "degrees") {
    text += rpe.at("pairs_from") == "estimate" ? ", measured on the estimate" : ", measured on the ground truth";
  }
  return text;
}

std::string segments_text(const Json& segments) {
  const char* tool = segments.at("rule") == "kitti" ? "KITTI's" : "rpg_trajectory_evaluation's";
  return fmt::format("by {} rule, {} {}", tool, fmt::join(segments.at("lengths").get<std::vector<double>>(), ", "),
                     segments.at("unit") == "percent" ? "% of the path" : "m");
}

std::string velocity_text(const VelocityScores& velocity) {
  const auto part = [](const RelativeVelocityError& error) {
    return fmt::format("median {:.4f}, AUC {:.4f}", error.median, error.auc);
  };
  const auto line = [&](const char* source, const VelocityErrors& errors) {
    if (!std::isfinite(errors.linear.auc)) return std::string();
    const std::string angular = std::isfinite(errors.angular.auc) ? "; angular: " + part(errors.angular) : "";
    return fmt::format("velocity, {}: RVE {}{}; {} times\n", source, part(errors.linear), angular, errors.times);
  };
  return (velocity.own ? line("its own", *velocity.own) : "") + line("differentiated", velocity.differentiated);
}

constexpr int kNameWidth = 15;  // "0.625 m [deg/m]"

std::string row(const std::string& name, const Statistics& s) {
  if (s.n == 0) return fmt::format("{:<{}} no pairs: no two poses are that far apart\n", name, kNameWidth);
  return fmt::format("{:<{}} {:>11.6f} {:>11.6f} {:>11.6f} {:>11.6f} {:>11.6f} {:>11.6f} {:>13.6f} {:>7}\n", name,
                     kNameWidth, s.rmse, s.mean, s.median, s.std, s.min, s.max, s.sse, s.n);
}

}  // namespace

std::string protocol(const Json& scores, const std::string& place, const ProtocolParts& parts) {
  try {
    std::string text = fmt::format("{}{}; {}", name_text(scores), alignment_text(scores.at("alignment")),
                                   association_text(scores.at("association")));
    if (parts.relative) text += "; " + relative_text(scores.at("rpe"));
    if (parts.segments && scores.contains("segments")) text += "; segments " + segments_text(scores.at("segments"));
    if (parts.latency && scores.contains("equal_latency") && !scores.at("equal_latency").is_null()) {
      text += fmt::format("; equal latency {} s", scores.at("equal_latency").at("latency_s").get<double>());
    }
    return text;
  } catch (const Json::exception& error) {
    throw InputError(fmt::format("{}: the protocol of the scores is incomplete: {}", place, json_reason(error)));
  }
}

std::string describe(const Scores& scores) {
  const Json json = to_json(scores);
  std::string text;
  if (const std::string name = name_text(json); !name.empty()) {
    text += fmt::format("protocol     {}\n", name.substr(0, name.size() - 2));
  }
  text += fmt::format("alignment    {}\n", alignment_text(json.at("alignment")));
  if (!scores.alignment.note.empty()) text += fmt::format("             {}\n", scores.alignment.note);
  text += fmt::format("association  {}\n", association_text(json.at("association")));
  text += fmt::format("relative     {}\n", relative_text(json.at("rpe")));
  if (json.contains("segments")) text += fmt::format("segments     {}\n", segments_text(json.at("segments")));
  text += fmt::format("pairs        {} poses compared, {}{:.1f} % of the ground truth's time covered\n", scores.pairs,
                      scores.unmatched > 0 ? fmt::format("{} of the estimate unmatched, ", scores.unmatched) : "",
                      100.0 * scores.coverage);
  text += fmt::format("scale        {:.6f}\n", scores.alignment.transform.scale);
  text += fmt::format("path         {:.6f} m\n\n", scores.path_m);
  text += fmt::format("{:<{}} {:>11} {:>11} {:>11} {:>11} {:>11} {:>11} {:>13} {:>7}\n", "", kNameWidth, "rmse", "mean",
                      "median", "std", "min", "max", "sse", "n");
  text += row("ATE [m]", scores.ate.trans_m);
  text += row("ATE [deg]", scores.ate.rot_deg);
  text += row("RPE [m]", scores.rpe.trans_m);
  text += row("RPE [deg]", scores.rpe.rot_deg);
  const auto is_too_long = [](const SegmentScores& segments) { return segments.trans_percent.n == 0; };
  if (!scores.by_length.empty() && std::ranges::all_of(scores.by_length, is_too_long)) {
    text += fmt::format("no two poses are {:.3g} m apart: no sub-trajectories\n", scores.by_length.front().length_m);
  }
  for (const SegmentScores& segments : scores.by_length) {
    if (is_too_long(segments)) continue;
    text += row(fmt::format("{:.3g} m [%]", segments.length_m), segments.trans_percent);
    text += row(fmt::format("{:.3g} m [deg/m]", segments.length_m), segments.rot_deg_per_m);
  }
  if (std::isfinite(scores.ate.trans_percent)) {
    text += fmt::format("\nATE {:.4f} % of the path\n", scores.ate.trans_percent);
  }
  if (const MeanErrors& mean = scores.mean; std::isfinite(mean.mpe_percent)) {
    text += fmt::format("MPE {:.4f} %, MRE {:.4f} deg/m, MYE {:.4f} deg/m: means over {:.6f} m of ground truth\n",
                        mean.mpe_percent, mean.mre_deg_per_m, mean.mye_deg_per_m, scores.ground_truth_path_m);
  }
  if (scores.velocity) text += velocity_text(*scores.velocity);
  return text;
}

}  // namespace evbench
