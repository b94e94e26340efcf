#include "bench/report/run_data.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <map>
#include <optional>
#include <sstream>

#include "bench/report/column.hpp"
#include "bench/scores_by_protocol.hpp"
#include "core/data/causal_poses.hpp"
#include "core/data/map_file.hpp"
#include "core/data/relative_poses.hpp"
#include "core/data/tracks.hpp"
#include "core/data/tum.hpp"
#include "core/data/velocity_file.hpp"
#include "core/geometry/so3.hpp"
#include "core/support/error.hpp"
#include "core/support/index.hpp"
#include "core/support/json_reason.hpp"
#include "eval/old_names.hpp"
#include "eval/score_run.hpp"

namespace evbench::report {
namespace {

constexpr double kMissing = std::numeric_limits<double>::quiet_NaN();
const Vector3 kNoVector = Vector3::Constant(kMissing);

bool exists(const std::string& path) {
  std::error_code error;
  return std::filesystem::is_regular_file(path, error);
}

std::string content(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

/// Columns x, y, z.
Json vectors(const std::vector<Vector3>& values, Json (*column_of)(std::span<const double>) = coarse) {
  Json columns = Json::array();
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> column;
    for (const Vector3& value : values) column.push_back(value[axis]);
    columns.push_back(column_of(column));
  }
  return columns;
}

Json orientations(const std::vector<Eigen::Quaterniond>& values) {
  Json columns = Json::array();
  for (int k = 0; k < 4; ++k) {
    std::vector<double> column;
    for (const Eigen::Quaterniond& value : values) column.push_back(value.coeffs()[k]);
    columns.push_back(coarse(column));
  }
  return columns;
}

const Eigen::Quaterniond kNoOrientation(kMissing, kMissing, kMissing, kMissing);

/// Of the two quaternions of a rotation the one that is nearer to the last, so that lines do not jump.
Eigen::Quaterniond on_one_side(const std::vector<Eigen::Quaterniond>& before, const Eigen::Quaterniond& q) {
  return before.empty() || !(before.back().dot(q) < 0.0) ? q : Eigen::Quaterniond(-q.coeffs());
}

/// The poses that are kept, and none in the middle of each hole: longer than 0.3 s, and than five usual steps.
std::vector<std::optional<std::size_t>> samples(const PoseTrajectory& trajectory, std::size_t most) {
  std::vector<std::optional<std::size_t>> result;
  if (trajectory.empty()) return result;
  const std::vector<StampedPose>& poses = trajectory.poses();
  const double step = (trajectory.end() - trajectory.start()) / static_cast<double>(poses.size());
  const double hole = std::max(0.3, 5.0 * step);
  std::size_t last = 0;
  for (const std::size_t i : thinned(poses.size(), most)) {
    for (std::size_t k = last + 1; k <= i; ++k) {
      if (poses[k].t - poses[k - 1].t <= hole) continue;
      if (result.back() != k - 1) result.emplace_back(k - 1);
      result.emplace_back(std::nullopt);
      if (k < i) result.emplace_back(k);
      break;
    }
    result.emplace_back(i);
    last = i;
  }
  return result;
}

/// A trajectory with velocities: stated ones, or differentiated where there are none.
Json trajectory_json(const PoseTrajectory& trajectory, const BodyVelocities& stated, const Similarity& transform,
                     double offset, std::size_t most) {
  std::vector<double> t;
  std::vector<Vector3> p, v, w;
  std::vector<Eigen::Quaterniond> q;
  for (const std::optional<std::size_t> i : samples(trajectory, most)) {
    if (!i) {  // a line is interrupted
      t.push_back(kMissing);
      for (auto* values : {&p, &v, &w}) values->push_back(kNoVector);
      q.push_back(kNoOrientation);
      continue;
    }
    const StampedPose& pose = trajectory.poses()[*i];
    const SE3 T = transform * pose.T;
    t.push_back(pose.t + offset);
    p.push_back(T.p);
    q.push_back(on_one_side(q, T.q));
    const auto velocity = stated.empty() ? differentiate(trajectory, pose.t) : stated.at(pose.t);
    v.push_back(velocity ? Vector3(transform.scale * velocity->tail<3>()) : kNoVector);
    w.push_back(velocity ? Vector3(velocity->head<3>()) : kNoVector);
  }
  for (std::size_t i = 1; i + 1 < t.size(); ++i) {
    if (std::isnan(t[i])) t[i] = 0.5 * (t[i - 1] + t[i + 1]);
  }
  return {{"t", times(t)}, {"p", vectors(p)}, {"q", orientations(q)}, {"v", vectors(v)}, {"w", vectors(w)}};
}

/// Adds the absolute errors at the kept times.
void add_errors(Json& estimate, const PoseTrajectory& trajectory, const Scores& scores, std::size_t most) {
  const PoseErrors errors = absolute_errors(scores.compared);
  std::map<double, std::size_t> at;
  for (std::size_t i = 0; i < scores.compared.size(); ++i) at[scores.compared[i].t] = i;
  std::vector<double> metres, degrees;
  for (const std::optional<std::size_t> i : samples(trajectory, most)) {
    const auto found = i ? at.find(trajectory.poses()[*i].t + scores.options.time_offset) : at.end();
    metres.push_back(found == at.end() ? kMissing : errors.trans_m[found->second]);
    degrees.push_back(found == at.end() ? kMissing : errors.rot_deg[found->second]);
  }
  estimate["error_m"] = coarse(metres);
  estimate["error_deg"] = coarse(degrees);
}

/// An estimate and its scores, if it has any.
struct Scored {
  RunEstimate estimate = {};
  std::optional<Scores> scores = {};
  std::string unscored = {};  ///< why it has none

  Similarity alignment() const { return scores ? scores->alignment.transform : Similarity(); }
  double offset() const { return scores ? scores->options.time_offset : 0.0; }
};

/// Does a part of the page; where files are damaged, adds the reason to `damage`.
template <class Make>
void attempt(std::vector<std::string>& damage, const Make& make) {
  try {
    make();
  } catch (const InputError& error) {
    damage.emplace_back(error.what());
  } catch (const Json::exception& error) {
    damage.emplace_back("metrics.json: " + json_reason(error));
  }
}

Scored read_scored(const RunRecord& run, const std::string& suffix, const PoseTrajectory& truth,
                   const ScoreOptions& protocol, std::vector<std::string>& damage) {
  const std::string velocities = file_of_run(run.folder, "velocities" + suffix + ".txt");
  Scored result;
  attempt(damage, [&] { result.estimate.poses = read_estimate(file_of_run(run.folder, "final" + suffix + ".tum")); });
  if (exists(velocities)) attempt(damage, [&] { result.estimate.velocities = read_velocities(velocities); });
  result.unscored = kNoGroundTruth;
  if (truth.empty() || result.estimate.poses.empty()) return result;
  try {
    result.scores = score(truth, result.estimate.poses, protocol);
  } catch (const InputError& error) {  // mostly too few poses to align: it is shown as it is
    result.unscored = error.what();
  }
  return result;
}

Json estimate_json(const Scored& scored, std::size_t most) {
  const RunEstimate& estimate = scored.estimate;
  Json json = trajectory_json(estimate.poses, estimate.velocities, scored.alignment(), scored.offset(), most);
  if (scored.scores) add_errors(json, estimate.poses, *scored.scores, most);
  return json;
}

Json segment_json(const RunRecord& run, std::size_t number, const RunSegment& segment, const Scored& scored,
                  const std::string& suffix, const Budget& budget, std::vector<std::string>& damage) {
  const std::string map_file = file_of_run(run.folder, "map" + suffix + ".ply");
  std::vector<Landmark> map;
  if (exists(map_file)) attempt(damage, [&] { map = read_map(map_file); });
  std::vector<Vector3> landmarks;
  for (const std::size_t i : thinned(map.size(), budget.landmarks())) {
    landmarks.push_back(scored.alignment() * map[i].position);
  }
  return {{"from", segment.from},
          {"to", segment.to},
          {"scored", number == run.status->scored},
          {"note", scored.scores ? "" : "not aligned: " + scored.unscored},
          {"poses", scored.estimate.poses.size()},
          {"estimate", estimate_json(scored, budget.trajectory())},
          {"landmarks", vectors(landmarks, single)},
          {"landmarks_total", map.size()}};
}

/// Roll, pitch and yaw [deg], R = Rz(yaw) Ry(pitch) Rx(roll).
Vector3 angles_deg(const Matrix3& R) {
  return kDegrees * Vector3(std::atan2(R(2, 1), R(2, 2)), std::asin(std::clamp(-R(2, 0), -1.0, 1.0)),
                            std::atan2(R(1, 0), R(0, 0)));
}

Vector3 turned_least(Vector3 degrees) {
  for (double& angle : degrees) angle -= 360.0 * std::round(angle / 360.0);
  return degrees;
}

/// Standard deviations of the newest published poses, in the gauge of the back-end's first pose. Null without
/// covariances.
Json newest_json(const RunRecord& run, const Scored& scored, const PoseTrajectory& truth, const Budget& budget) {
  const std::string path = run.folder + "/covariance.txt";
  if (!exists(path)) return nullptr;
  std::vector<RelativePose> newest;
  for (RelativePose& pose : read_relative_poses(path)) {
    if (pose.kind == "newest") newest.push_back(std::move(pose));
  }
  std::map<double, SE3> published;
  if (const std::string causal = file_of_run(run.folder, "causal.tum"); !newest.empty() && exists(causal)) {
    const PoseTrajectory poses = read_estimate(causal);
    for (const StampedPose& pose : poses.poses()) published[pose.t] = pose.T;
  }
  const Similarity alignment = scored.alignment();
  std::vector<double> t;
  std::vector<Vector3> p, sigma_m, sigma_deg, error_m, error_deg;
  std::vector<Eigen::Quaterniond> q;
  for (const std::size_t i : thinned(newest.size(), budget.covariances())) {
    const RelativePose& relative = newest[i];
    const auto found = published.lower_bound(relative.t1 - 1e-6);
    if (found == published.end() || found->first > relative.t1 + 1e-6) continue;
    const SE3 T = alignment * found->second;
    const Matrix3 R = T.R();
    const Matrix3 position =
        alignment.scale * alignment.scale * (R * relative.covariance.bottomRightCorner<3, 3>() * R.transpose());
    Matrix3 J;  // of the angles, for R Exp(δ)
    constexpr double kStep = 1e-6;
    for (int axis = 0; axis < 3; ++axis) {
      const Vector3 step = kStep * Vector3::Unit(axis);
      const Matrix3 ahead = (T.q * so3::exp(step)).toRotationMatrix(),
                    behind = (T.q * so3::exp(-step)).toRotationMatrix();
      J.col(axis) = turned_least(angles_deg(ahead) - angles_deg(behind)) / (2.0 * kStep);
    }
    const Matrix3 rotation = J * relative.covariance.topLeftCorner<3, 3>() * J.transpose();
    t.push_back(relative.t1 + scored.offset());
    p.push_back(T.p);
    q.push_back(on_one_side(q, T.q));
    sigma_m.push_back(position.diagonal().cwiseMax(0.0).cwiseSqrt());
    sigma_deg.push_back(rotation.diagonal().cwiseMax(0.0).cwiseSqrt());
    const std::optional<SE3> true_pose = truth.empty() ? std::nullopt : truth.pose(t.back());
    error_m.push_back(true_pose ? Vector3(T.p - true_pose->p) : kNoVector);
    error_deg.push_back(true_pose ? turned_least(angles_deg(R) - angles_deg(true_pose->R())) : kNoVector);
  }
  if (t.empty()) return nullptr;
  return {{"t", times(t)},
          {"p", vectors(p)},
          {"q", orientations(q)},
          {"sigma_m", vectors(sigma_m)},
          {"sigma_deg", vectors(sigma_deg)},
          {"error_m", vectors(error_m)},
          {"error_deg", vectors(error_deg)}};
}

Json causal_json(const RunRecord& run, const Scored& scored, const ScoreOptions& protocol, const Budget& budget) {
  Scored causal{read_run_estimate(run.folder, true), {}};
  if (causal.estimate.poses.empty()) return nullptr;
  if (scored.scores) {
    try {
      causal.scores = score_estimate(run.folder, true, protocol, run).scores;
    } catch (const InputError&) {
    }
  }
  return estimate_json(causal, budget.causal());
}

/// The numbers of a CSV file by the name of their column; NaN: an empty cell.
std::vector<std::pair<std::string, std::vector<double>>> read_csv(const std::string& path) {
  std::vector<std::pair<std::string, std::vector<double>>> columns;
  std::ifstream file(path);
  std::string line, cell;
  if (!std::getline(file, line)) return columns;
  for (std::istringstream cells(line); std::getline(cells, cell, ',');) columns.push_back({cell, {}});
  while (std::getline(file, line)) {
    std::istringstream cells(line);
    for (auto& [name, values] : columns) {
      cell.clear();
      std::getline(cells, cell, ',');
      values.push_back(cell.empty() ? kMissing : std::strtod(cell.c_str(), nullptr));
    }
  }
  return columns;
}

/// Of equal parts of the updates the slowest one of each.
std::vector<std::size_t> slowest(const std::vector<double>& ms, std::size_t most) {
  std::vector<std::size_t> indices;
  const std::size_t parts = std::min(ms.size(), most);
  for (std::size_t part = 0; part < parts; ++part) {
    const auto first = ms.begin() + static_cast<std::ptrdiff_t>(part * ms.size() / parts);
    const auto last = ms.begin() + static_cast<std::ptrdiff_t>((part + 1) * ms.size() / parts);
    indices.push_back(static_cast<std::size_t>(std::max_element(first, last) - ms.begin()));
  }
  return indices;
}

std::vector<double> chosen(const std::vector<double>& values, const std::vector<std::size_t>& indices) {
  std::vector<double> result;
  for (const std::size_t i : indices) result.push_back(values[i]);
  return result;
}

void add_updates(const RunRecord& run, const Budget& budget, Json& json) {
  json["updates"] = nullptr;
  json["control_times"] = nullptr;
  std::map<std::string, std::vector<double>> columns;
  for (auto& [name, values] : read_csv(run.folder + "/timing.csv")) columns[name] = std::move(values);
  const std::size_t count = columns["t_s"].size();
  for (const char* name : {"update_ms", "states", "landmarks"}) {
    if (columns[name].size() != count)
      throw InputError(fmt::format("{}/timing.csv: has no {} a line", run.folder, name));
  }
  if (count == 0) return;
  const std::vector<std::size_t> kept = slowest(columns["update_ms"], budget.updates());
  json["updates"] = {{"total", columns["t_s"].size()},
                     {"t", times(chosen(columns["t_s"], kept))},
                     {"ms", single(chosen(columns["update_ms"], kept))},
                     {"states", coarse(chosen(columns["states"], kept))},
                     {"landmarks", coarse(chosen(columns["landmarks"], kept))}};
  std::vector<double> states;
  for (const double t : columns["t_s"]) {
    if (states.empty() || t > states.back()) states.push_back(t);
  }
  json["control_times"] = times(chosen(states, thinned(states.size(), budget.updates())));
}

std::string unit_of(const std::string& parameter) {
  if (parameter.find("qc_rotation") != std::string::npos) return "rad²/s³";
  if (parameter.find("qc_translation") != std::string::npos) return "units²/s³";
  return "";
}

Json parameters_json(const RunRecord& run, const Budget& budget) {
  const auto columns = read_csv(run.folder + "/estimated_parameters.csv");
  if (columns.size() < 2 || columns.front().second.empty()) return nullptr;
  const std::vector<std::size_t> kept = thinned(columns.front().second.size(), budget.parameters());
  Json json = {{"t", times(chosen(columns.front().second, kept))}, {"columns", Json::array()}};
  for (std::size_t i = 1; i < columns.size(); ++i) {
    json["columns"].push_back({{"name", columns[i].first},
                               {"unit", unit_of(columns[i].first)},
                               {"values", coarse(chosen(columns[i].second, kept))}});
  }
  return json;
}

/// What lies between a track's beginning, or its re-acquisition, and its end.
struct Piece {
  std::size_t row;
  double from, to;
  bool reacquired;
};

Json tracks_json(const RunRecord& run, const Budget& budget) {
  const std::string path = run.folder + "/tracks.txt";
  if (!exists(path) || std::filesystem::file_size(path) == 0) return nullptr;
  std::map<TrackId, std::vector<double>> ends;
  if (const std::string file = run.folder + "/track_ends.txt"; exists(file)) {
    for (const TrackEnd& end : read_track_ends(file)) ends[end.track].push_back(end.t);
  }
  const TrackFile file = read_tracks(path, kAnySize, kAnySize);
  std::map<TrackId, std::pair<std::size_t, std::size_t>> last;  // row, its newest piece
  std::vector<Piece> pieces;
  for (const TrackObservation& z : file.observations) {
    const auto [entry, is_new] = last.try_emplace(z.track, last.size(), pieces.size());
    const auto has_ended = [&](double since) {
      const auto& all = ends[z.track];
      return std::ranges::any_of(all, [&](double t) { return t >= since && t < z.t; });
    };
    if (is_new || has_ended(pieces[entry->second.second].to)) {
      entry->second.second = pieces.size();
      pieces.push_back({entry->second.first, z.t, z.t, !is_new});
    } else {
      pieces[entry->second.second].to = z.t;
    }
  }
  const std::size_t tracks = last.size();
  const std::size_t every = (tracks + budget.tracks() - 1) / budget.tracks();
  std::vector<double> row, from, to, reacquired;
  for (const Piece& piece : pieces) {
    if (piece.row % every != 0) continue;
    row.push_back(static_cast<double>(piece.row));
    from.push_back(piece.from);
    to.push_back(piece.to);
    reacquired.push_back(piece.reacquired ? 1.0 : 0.0);
  }
  std::vector<double> live_t, live;
  const double begin = file.observations.front().t, end = file.observations.back().t;
  const std::size_t samples = budget.updates();
  std::vector<double> begins, finishes;
  for (const Piece& piece : pieces) {
    begins.push_back(piece.from);
    finishes.push_back(piece.to);
  }
  std::ranges::sort(begins);
  std::ranges::sort(finishes);
  for (std::size_t i = 0; i <= samples; ++i) {
    const double t = begin + (end - begin) * static_cast<double>(i) / static_cast<double>(samples);
    live_t.push_back(t);
    live.push_back(static_cast<double>(std::ranges::upper_bound(begins, t) - begins.begin()) -
                   static_cast<double>(std::ranges::lower_bound(finishes, t) - finishes.begin()));
  }
  return {{"total", tracks},
          {"row", coarse(row)},
          {"from", times(from)},
          {"to", times(to)},
          {"reacquired", coarse(reacquired)},
          {"live_t", times(live_t)},
          {"live", coarse(live)}};
}

Json periods_json(const RunRecord& run) {
  Json periods = Json::array();
  if (!run.status) return periods;
  const auto add = [&](const char* kind, double from, double to, const std::string& text) {
    periods.push_back({{"kind", kind}, {"from", from}, {"to", to}, {"text", text}});
  };
  for (const TimeRange& range : run.status->stationary)
    add("stationary", range.from, range.to, "the camera is at rest");
  for (const DegradedSpan& span : run.status->status.degraded) {
    add(span.reason.starts_with("lost") ? "lost" : "degraded", span.from, span.to, span.reason);
  }
  const bool is_lost = run.status->status.state == RunState::lost;
  if (is_lost && run.range && std::isfinite(run.range->to) && run.status->status.time < run.range->to) {
    add("lost", run.status->status.time, run.range->to, run.status->status.reason);
  }
  return periods;
}

/// In time order.
Json events_json(const RunRecord& run) {
  if (!run.events.is_array()) return Json::array();
  std::vector<Json> events(run.events.begin(), run.events.end());
  std::ranges::stable_sort(events, {}, [](const Json& event) { return event.value("t", 0.0); });
  return events;
}

/// The first and the last lines of a long text.
std::string shortened(const std::string& text, std::size_t most) {
  if (text.size() <= most) return text;
  const std::size_t first = text.rfind('\n', most / 2), last = text.find('\n', text.size() - most / 2);
  if (first == std::string::npos || last == std::string::npos || first >= last) return text.substr(0, most);
  return text.substr(0, first) + "\n...\n" + text.substr(last + 1);
}

Json scores_json(const RunRecord& run) {
  Json facts = Json::array();
  const Json& scores = run.final_scores;
  if (scores.is_null()) return facts;
  const auto add = [&](const char* name, const Json& value, const char* unit, double factor = 1.0) {
    if (value.is_number())
      facts.push_back({{"name", name}, {"value", fmt::format("{:.3g} {}", factor * value.get<double>(), unit)}});
  };
  add("ATE", scores["ate"]["trans_m"]["rmse"], "m");
  add("ATE", scores["ate"]["trans_percent"], "% of the path");
  add("ATE", scores["ate"]["rot_deg"]["rmse"], "deg");
  add("RPE", scores["rpe"]["trans_m"]["rmse"], "m");
  if (scores.contains("velocity")) add("velocity AUC", scores["velocity"]["rve"]["auc"], "");
  add("covered", scores["coverage"], "%", 100.0);
  if (run.realtime_factor) add("real-time factor", Json(*run.realtime_factor), "");
  return facts;
}

}  // namespace

Json ground_truth_json(const RunRecord& run, const Budget& budget) {
  const std::string path = run.folder + "/groundtruth.tum";
  if (!exists(path)) return nullptr;
  PoseTrajectory truth;
  try {
    truth = read_tum(path);
  } catch (const InputError&) {  // run_json() says so
    return nullptr;
  }
  if (run.range) truth = truth.cut(run.range->from, run.range->to);
  return truth.empty() ? Json() : trajectory_json(truth, {}, {}, 0.0, budget.trajectory());
}

Json run_json(const RunRecord& run, const std::string& protocol, const Budget& budget,
              std::vector<std::string>& damage) {
  Json json = {{"label", run.label},
               {"experiment", run.experiment},
               {"folder", run.folder},
               {"key", run.key},
               {"state", !run.done    ? "not run"
                         : run.status ? to_string(run.status->status.state)
                                      : "ok"},
               {"reason", !run.damage.empty() ? run.damage
                          : run.status        ? run.status->status.reason
                                              : ""},
               {"time", nullptr},
               {"alignment", ""},
               {"scores", Json::array()},
               {"segments", Json::array()},
               {"causal", nullptr},
               {"newest", nullptr},
               {"control_times", nullptr},
               {"periods", periods_json(run)},
               {"events", Json::array()},
               {"tracks", nullptr},
               {"updates", nullptr},
               {"parameters", nullptr},
               {"log", ""},
               {"config", ""}};
  if (!run.done) return json;
  attempt(damage, [&] { json["scores"] = scores_json(run); });
  attempt(damage, [&] { json["events"] = events_json(run); });
  if (run.status && run.status->status.state != RunState::ok) json["time"] = run.status->status.time;
  json["log"] = shortened(content(run.folder + "/log.txt"), budget.log_characters());
  if (budget.shows_details()) json["config"] = content(run.folder + "/config.json");
  const std::string truth_file = run.folder + "/groundtruth.tum";
  PoseTrajectory truth;
  if (exists(truth_file)) attempt(damage, [&] { truth = read_tum(truth_file); });
  if (run.range) truth = truth.cut(run.range->from, run.range->to);
  ScoreOptions options;
  attempt(damage, [&] { options = protocol_of(run, protocol); });
  if (run.status) {
    for (std::size_t i = 0; i < run.status->segments.size(); ++i) {
      const bool is_scored = i + 1 == run.status->scored || run.status->segments.size() == 1;
      const std::string suffix = is_scored ? "" : fmt::format(".segment{}", i + 1);
      const Scored scored = read_scored(run, suffix, truth, options, damage);
      if (scored.estimate.poses.empty()) continue;
      json["segments"].push_back(segment_json(run, i + 1, run.status->segments[i], scored, suffix, budget, damage));
      if (!is_scored) continue;
      if (scored.scores) {
        json["alignment"] = fmt::format("{}, scale {:.4g}", scored.scores->options.alignment, scored.alignment().scale);
      }
      if (budget.shows_details()) {
        attempt(damage, [&] { json["causal"] = causal_json(run, scored, options, budget); });
      }
      attempt(damage, [&] { json["newest"] = newest_json(run, scored, truth, budget); });
    }
  }
  attempt(damage, [&] { add_updates(run, budget, json); });
  attempt(damage, [&] { json["parameters"] = parameters_json(run, budget); });
  attempt(damage, [&] { json["tracks"] = tracks_json(run, budget); });
  return json;
}

}  // namespace evbench::report
