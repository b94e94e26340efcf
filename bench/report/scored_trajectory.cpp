#include "bench/report/scored_trajectory.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "bench/report/column.hpp"
#include "bench/report/damage.hpp"
#include "bench/report/thinning.hpp"
#include "eval/score_run.hpp"

namespace evbench::report {
namespace {

const Eigen::Quaterniond kNoOrientation(kMissing, kMissing, kMissing, kMissing);

/// Indices of poses; none where a line is interrupted.
using Kept = std::vector<std::optional<std::size_t>>;

/// The poses that are kept, and none in the middle of each hole: longer than 0.3 s, and than five usual steps.
Kept kept_of(const PoseTrajectory& trajectory, std::size_t most) {
  Kept result;
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

Json curve_json(const PoseTrajectory& trajectory, const Kept& kept, const BodyVelocities& stated,
                const Similarity& transform, double offset) {
  std::vector<double> t;
  std::vector<Vector3> p, v, w;
  std::vector<Eigen::Quaterniond> q;
  for (const std::optional<std::size_t> i : kept) {
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
void add_errors(Json& estimate, const PoseTrajectory& trajectory, const Kept& kept, const Scores& scores) {
  const PoseErrors errors = absolute_errors(scores.compared);
  std::map<double, std::size_t> at;
  for (std::size_t i = 0; i < scores.compared.size(); ++i) at[scores.compared[i].t] = i;
  std::vector<double> metres, degrees;
  for (const std::optional<std::size_t> i : kept) {
    const auto found = i ? at.find(trajectory.poses()[*i].t + scores.options.time_offset) : at.end();
    metres.push_back(found == at.end() ? kMissing : errors.trans_m[found->second]);
    degrees.push_back(found == at.end() ? kMissing : errors.rot_deg[found->second]);
  }
  estimate["error_m"] = coarse(metres);
  estimate["error_deg"] = coarse(degrees);
}

}  // namespace

ScoredTrajectory read_scored(const RunRecord& run, const EstimateName& name, const PoseTrajectory& truth,
                             const ScoreOptions& protocol, std::vector<std::string>& damage) {
  ScoredTrajectory result;
  attempt(damage, [&] { result.estimate.poses = read_run_poses(run.folder, name); });
  attempt(damage, [&] { result.estimate.velocities = read_run_velocities(run.folder, name); });
  try {
    result.scores = score_poses(truth, result.estimate.poses, protocol, run);
  } catch (const InputError& error) {  // mostly too few poses to align: it is shown as it is
    result.unscored = error.what();
  }
  return result;
}

Json trajectory_json(const PoseTrajectory& trajectory, std::size_t most) {
  return curve_json(trajectory, kept_of(trajectory, most), {}, {}, 0.0);
}

Json estimate_json(const ScoredTrajectory& scored, std::size_t most) {
  const auto& [poses, velocities] = scored.estimate;
  const Kept kept = kept_of(poses, most);
  Json json = curve_json(poses, kept, velocities, scored.alignment(), scored.offset());
  if (scored.scores) add_errors(json, poses, kept, *scored.scores);
  return json;
}

}  // namespace evbench::report
