#include "eval/scores.hpp"

#include <cmath>

#include "core/support/index.hpp"
#include "eval/protocols.hpp"

namespace evbench {
namespace {

TimeRange parse_range(const OptionSet::List& list, const char* name) {
  if (list.empty()) return {};
  if (list.size() != 2 || !(list[0] < list[1])) {
    throw InputError(fmt::format("{}: expected two rising times in seconds", name));
  }
  return {list[0], list[1]};
}

AssociationOptions association_options(const ScoreOptions& options) {
  return {.mode = parse_name<AssociationMode>(kAssociationNames, options.association, "association"),
          .tolerance = options.tolerance,
          .time_offset = options.time_offset,
          .range = parse_range(options.time_range, "time_range"),
          .min_pairs = static_cast<std::size_t>(options.min_pairs)};
}

SegmentOptions segment_options(const ScoreOptions& options) {
  return with_own_lengths({.rule = parse_name<SegmentRule>(kSegmentRuleNames, options.segments, "rule of segments"),
                           .lengths = options.segment_lengths,
                           .unit = parse_name<LengthUnit>(kLengthUnitNames, options.segment_unit, "unit of segments")});
}

/// The pairs on which the alignment is computed.
std::vector<PosePair> pairs_to_align(const std::vector<PosePair>& pairs, const ScoreOptions& options) {
  TimeRange range = parse_range(options.align_range, "align_range");
  if ((options.align_first > 0) + !options.align_range.empty() + !options.align_seconds.empty() > 1) {
    throw InputError("two of align_first, align_range and align_seconds are given; expected one of them");
  }
  if (!options.align_seconds.empty()) {
    const TimeRange seconds = parse_range(options.align_seconds, "align_seconds");
    range = {pairs.front().t + seconds.from, pairs.front().t + seconds.to};
  }
  std::vector<PosePair> result;
  std::ranges::copy_if(pairs, std::back_inserter(result), [&](const PosePair& pair) { return range.contains(pair.t); });
  const auto first = static_cast<std::size_t>(options.align_first);
  if (first > 0 && first < result.size()) result.resize(first);
  return result;
}

void score_segments(const std::vector<SegmentErrors>& segments, Scores& scores) {
  std::vector<double> trans, rot;
  for (const SegmentErrors& errors : segments) {
    scores.by_length.push_back({errors.length_m, statistics(errors.trans_percent), statistics(errors.rot_deg_per_m)});
    std::ranges::copy(errors.trans_percent, std::back_inserter(trans));
    std::ranges::copy(errors.rot_deg_per_m, std::back_inserter(rot));
  }
  scores.all_segments = {0.0, statistics(trans), statistics(rot)};
}

/// Absolute rotation errors without the common rotation of all poses.
PoseErrors centred(std::vector<PosePair> pairs) {
  const SE3 rotation{common_rotation(pairs), Vector3::Zero()};
  for (PosePair& pair : pairs) pair.estimate = rotation * pair.estimate;
  return absolute_errors(pairs);
}

MeanErrors mean_errors(const AbsoluteScores& ate, const std::vector<PosePair>& pairs, double path_m) {
  if (!(path_m > 0.0)) return {};
  double yaw_deg = 0.0;
  for (const PosePair& pair : pairs) yaw_deg += yaw_error_deg(pair);
  return {100.0 * ate.trans_m.mean / path_m, ate.rot_deg.mean / path_m,
          yaw_deg / static_cast<double>(pairs.size()) / path_m};
}

double path_length(const std::vector<PosePair>& pairs) {
  double length = 0.0;
  for (std::size_t i = 1; i < pairs.size(); ++i) {
    length += (pairs[i].ground_truth.p - pairs[i - 1].ground_truth.p).norm();
  }
  return length;
}

}  // namespace

void ScoreOptions::declare(OptionSet& set) {
  set.add("protocol", protocol,
          "a published protocol by name (evbench list protocols): the values of all options here that are not given "
          "beside it, but for time_offset, time_range, min_pairs and latency")
      .choices(protocol_choices());
  set.add("alignment", alignment, "how the estimate is aligned to the ground truth")
      .choices(to_strings(kAlignmentNames));
  set.add("align_first", align_first, "align on this many first poses only; 0: on all").range(0);
  set.add("align_range", align_range, "align on the poses in this time range only [s]; empty: on all").size(2).rising();
  set.add("align_seconds", align_seconds,
          "align on the poses between these times after the first compared pose only [s]; empty: on all")
      .size(2)
      .rising();
  set.add("association", association, "ground truth with which a pose is compared")
      .choices(to_strings(kAssociationNames));
  set.add("tolerance", tolerance, "largest time difference between a compared pose and its ground truth [s]")
      .range(0.0);
  set.add("time_offset", time_offset, "added to the estimate's times [s]");
  set.add("time_range", time_range, "evaluate in this time range of the ground truth only [s]; empty: all")
      .size(2)
      .rising();
  set.add("min_pairs", min_pairs, "fewer compared poses are an error").range(3);
  set.add("latency", latency,
          "time after which each pose is taken for scores at equal latency, the same for all back-ends of a table "
          "[s]")
      .range(0.0, 10.0);
  set.add("rpe_delta", rpe_delta, "distance of the two poses of a relative error [rpe_unit]").above(0.0);
  set.add("rpe_unit", rpe_unit, "unit of that distance").choices(to_strings(kDeltaUnitNames));
  set.add("rpe_pairing", rpe_pairing, "from every pose, or in one chain").choices(to_strings(kPairingNames));
  set.add("rpe_tolerance", rpe_tolerance, "largest deviation of a pair from rpe_delta, relative to it").range(0.0);
  set.add("rpe_pairs_from", rpe_pairs_from, "trajectory on which metres and degrees are measured")
      .choices(to_strings(kPairSourceNames));
  set.add("segments", segments, "also compute errors over sub-trajectories, in % and deg/m, by this definition")
      .choices(to_strings(kSegmentRuleNames));
  set.add("segment_lengths", segment_lengths,
          "lengths of sub-trajectories [segment_unit]; empty: 10 to 50 % (rpg), 100 to 800 m (kitti)")
      .above(0.0);
  set.add("segment_unit", segment_unit, "unit of these lengths: metres, or percent of the ground truth's path")
      .choices(to_strings(kLengthUnitNames));
}

RelativeOptions relative_options(const ScoreOptions& options) {
  return {.delta = options.rpe_delta,
          .unit = parse_name<DeltaUnit>(kDeltaUnitNames, options.rpe_unit, "unit of the RPE delta"),
          .pairing = parse_name<Pairing>(kPairingNames, options.rpe_pairing, "RPE pairing"),
          .tolerance = options.rpe_tolerance,
          .source = parse_name<PairSource>(kPairSourceNames, options.rpe_pairs_from, "source of RPE pairs")};
}

Scores score(const PoseTrajectory& ground_truth, const PoseTrajectory& estimate, const ScoreOptions& options) {
  const auto method = parse_name<AlignmentMethod>(kAlignmentNames, options.alignment, "alignment");
  const RelativeOptions relative = relative_options(options);
  Association association = associate(ground_truth, estimate, association_options(options));
  std::vector<PosePair>& pairs = association.pairs;

  Scores scores;
  scores.options = options;
  scores.pairs = pairs.size();
  scores.unmatched = association.unmatched;
  scores.coverage = association.coverage;
  scores.path_m = path_length(pairs);

  const TimeRange range = parse_range(options.time_range, "time_range");
  const PoseTrajectory truth = ground_truth.cut(range.from, range.to);
  const std::vector<PosePair> aligned = pairs_to_align(pairs, options);
  scores.alignment = align(aligned, method);
  scores.aligned_pairs = method == AlignmentMethod::none ? 0 : aligned.size();
  for (PosePair& pair : pairs) pair.estimate = scores.alignment.transform * pair.estimate;

  const PoseErrors absolute = absolute_errors(pairs);
  scores.ate.trans_m = statistics(absolute.trans_m);
  scores.ate.rot_deg = statistics(absolute.rot_deg);
  scores.ate.rot_centred_deg = statistics(centred(pairs).rot_deg);
  if (scores.path_m > 0.0) scores.ate.trans_percent = 100.0 * scores.ate.trans_m.rmse / scores.path_m;
  scores.ground_truth_path_m = truth.path_length();
  scores.mean = mean_errors(scores.ate, pairs, scores.ground_truth_path_m);

  const PoseErrors steps = relative_errors(pairs, delta_pairs(pairs, relative));
  scores.rpe.trans_m = statistics(steps.trans_m);
  scores.rpe.rot_deg = statistics(steps.rot_deg);

  score_segments(segment_errors(pairs, segment_options(options), scores.ground_truth_path_m), scores);
  scores.compared = std::move(pairs);
  return scores;
}

void score_velocities(const PoseTrajectory& ground_truth, const BodyVelocities& true_velocities,
                      const PoseTrajectory& estimate, const BodyVelocities& own, Scores& scores) {
  const double offset = scores.options.time_offset, scale = scores.alignment.transform.scale;
  std::vector<VelocityPair> differentiated, stated;
  for (const PosePair& pair : scores.compared) {
    const std::optional<Vector6> truth =
        true_velocities.empty() ? differentiate(ground_truth, pair.t) : true_velocities.at(pair.t);
    if (!truth) continue;
    const auto scaled = [&](Vector6 velocity) {
      velocity.tail<3>() *= scale;
      return velocity;
    };
    if (const auto velocity = differentiate(estimate, pair.t - offset))
      differentiated.push_back({*truth, scaled(*velocity)});
    if (const auto velocity = own.at(pair.t - offset)) stated.push_back({*truth, scaled(*velocity)});
  }
  VelocityScores result;
  result.differentiated = velocity_errors(differentiated);
  if (!stated.empty()) result.own = velocity_errors(stated);
  scores.velocity = result;
}

namespace {

Json number_or_null(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

Json to_json(const VelocityErrors& errors) {
  const auto relative = [](const RelativeVelocityError& error) {
    return Json{{"auc", number_or_null(error.auc)}, {"median", number_or_null(error.median)}};
  };
  return {{"rve", relative(errors.linear)}, {"angular", relative(errors.angular)}, {"times", errors.times}};
}

Json to_json(const VelocityScores& velocity) {
  Json json = to_json(velocity.own.value_or(velocity.differentiated));
  json["source"] = velocity.own ? "own" : "differentiated";
  json["differentiated"] = to_json(velocity.differentiated);
  return json;
}

/// [from, to], with null for an open end; null for all times.
Json range_json(const OptionSet::List& list) {
  if (list.empty()) return nullptr;
  Json range = Json::array();
  for (const double t : list) range.push_back(std::isfinite(t) ? Json(t) : Json(nullptr));
  return range;
}

Json segments_json(const Scores& scores) {
  const SegmentOptions options = segment_options(scores.options);
  Json json = {{"rule", scores.options.segments},
               {"lengths", options.lengths},
               {"unit", kLengthUnitNames[index(options.unit)]},
               {"trans_percent", to_json(scores.all_segments.trans_percent)},
               {"rot_deg_per_m", to_json(scores.all_segments.rot_deg_per_m)},
               {"by_length", Json::array()}};
  for (const SegmentScores& segments : scores.by_length) {
    json["by_length"].push_back({{"length_m", segments.length_m},
                                 {"trans_percent", to_json(segments.trans_percent)},
                                 {"rot_deg_per_m", to_json(segments.rot_deg_per_m)}});
  }
  return json;
}

}  // namespace

Json to_json(const Scores& scores) {
  const ScoreOptions& options = scores.options;
  Json json;
  json["protocol"] = protocol_json(options);
  json["ate"] = {{"trans_m", to_json(scores.ate.trans_m)},
                 {"rot_deg", to_json(scores.ate.rot_deg)},
                 {"rot_centred_deg", to_json(scores.ate.rot_centred_deg)},
                 {"trans_percent", number_or_null(scores.ate.trans_percent)}};
  json["mpe_percent"] = number_or_null(scores.mean.mpe_percent);
  json["mre_deg_per_m"] = number_or_null(scores.mean.mre_deg_per_m);
  json["mye_deg_per_m"] = number_or_null(scores.mean.mye_deg_per_m);
  json["rpe"] = {{"trans_m", to_json(scores.rpe.trans_m)}, {"rot_deg", to_json(scores.rpe.rot_deg)},
                 {"pairs", scores.rpe.trans_m.n},          {"delta", options.rpe_delta},
                 {"delta_unit", options.rpe_unit},         {"pairing", options.rpe_pairing},
                 {"tolerance", options.rpe_tolerance},     {"pairs_from", options.rpe_pairs_from}};
  if (options.segments != "none") json["segments"] = segments_json(scores);
  if (scores.velocity) json["velocity"] = to_json(*scores.velocity);
  json["pairs"] = scores.pairs;
  json["coverage"] = scores.coverage;
  json["span_s"] = {scores.compared.front().t, scores.compared.back().t};
  json["scale"] = scores.alignment.transform.scale;
  json["path_m"] = scores.path_m;
  json["ground_truth_path_m"] = scores.ground_truth_path_m;
  json["alignment"] = {{"method", options.alignment},
                       {"poses", scores.aligned_pairs},
                       {"first", options.align_first > 0 ? Json(options.align_first) : Json(nullptr)},
                       {"range_s", range_json(options.align_range)},
                       {"seconds", range_json(options.align_seconds)},
                       {"note", scores.alignment.note}};
  json["association"] = {{"mode", options.association},
                         {"tolerance_s", options.tolerance},
                         {"time_offset_s", options.time_offset},
                         {"time_range_s", range_json(options.time_range)}};
  return json;
}

}  // namespace evbench
