#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <set>

#include "bench/figures/figure_runs.hpp"
#include "bench/run_folder.hpp"
#include "core/support/error.hpp"
#include "core/support/index.hpp"
#include "eval/score_run.hpp"

namespace evbench {
namespace {

/// Whether a column is the same for all runs of one sequence: it then identifies the sequence.
bool tells_sequence(const RunColumn& column, const std::vector<std::string>& sequences) {
  std::map<std::string, std::string> values;
  for (std::size_t i = 0; i < sequences.size(); ++i) {
    if (values.try_emplace(sequences[i], column.values[i]).first->second != column.values[i]) return false;
  }
  return true;
}

/// The name of a run's sequence by these columns, such as "sequence fast, seed 1". `sequences`: of all runs.
std::string name_of_sequence(const std::vector<RunColumn>& columns, const std::vector<std::string>& sequences,
                             std::size_t run) {
  std::string name;
  for (const RunColumn& column : columns) {
    const bool told_elsewhere = column.name == "experiment" || column.name == "label";
    if (told_elsewhere || column.values[run].empty() || !tells_sequence(column, sequences)) continue;
    name += fmt::format("{}{} {}", name.empty() ? "" : ", ", column.name, column.values[run]);
  }
  return name;
}

/// The runs of the first sequence, scored by their own protocols.
ScoredTrajectories score_first_sequence(std::span<const RunRecord> records, const FigureRuns& all,
                                        const FigureOptions& options, const std::string& what) {
  ScoredTrajectories result;
  std::vector<std::string> sequences;
  for (const RunRecord& run : records) sequences.push_back(sequence_of(run));
  const std::size_t first = all.methods.front().runs.front();
  const std::string name = name_of_sequence(all.columns, sequences, first);
  std::string missing;
  std::vector<RunRecord> drawn;
  std::set<std::string> distinct;
  for (const Method& method : all.methods) {
    for (const std::size_t i : method.runs) {
      const RunRecord& run = records[i];
      distinct.insert(sequences[i]);
      if (sequences[i] != sequences[first]) continue;
      drawn.push_back(run);
      if (all.runs[i].scores().is_null()) {
        const std::string& unscored = options.causal ? run.causal_unscored : run.final_unscored;
        missing += fmt::format(" {} is not drawn: {}.", method.name, unscored.empty() ? "it failed" : unscored);
        continue;
      }
      result.names.push_back(method.name);
      result.scores.push_back(score_estimate(run.folder, options.causal, protocol_of_run(run.folder), run).scores);
    }
  }
  if (result.scores.empty()) {
    throw InputError(
        fmt::format("none of these runs has an estimate and ground truth{}; expected one that has, say by --only.{}",
                    name.empty() ? "" : ": " + name, missing));
  }
  const std::string others =
      distinct.size() > 1 ? fmt::format(" (the first of {} sequences and seeds)", distinct.size()) : "";
  const FigureRuns of_sequence(drawn, options.causal);
  result.caption = of_sequence.scored_caption(
      fmt::format("{}{}{}{}.{}", what, name.empty() ? "" : ", ", name, others, missing), options.causal, {});
  return result;
}

constexpr int kTime = -1;

const char* time_label(const ScoredTrajectories& scored) { return scored.numbered ? "number of the pose" : "time [s]"; }

/// The axes of each panel: time, or a coordinate.
Figure figure_of_trajectories(const ScoredTrajectories& scored, const std::vector<std::pair<int, int>>& axes) {
  Figure figure;
  figure.series.push_back({"ground truth", true});
  for (const std::string& name : scored.names) figure.series.push_back({name});
  const auto longest = std::ranges::max_element(scored.scores, {}, &Scores::coverage);
  const std::array names{"x [m]", "y [m]", "z [m]"};
  for (const auto& [across, up] : axes) {
    Panel panel{{across == kTime ? time_label(scored) : names[index(across)]}, {names[index(up)]}, {}};
    panel.equal = across != kTime;
    const auto add = [&, across = across, up = up](std::size_t series, const std::vector<PosePair>& pairs, auto pose) {
      Mark line{Mark::Kind::line, series, {}};
      for (const PosePair& pair : pairs) {
        line.x.push_back(across == kTime ? pair.t : pose(pair).p[across]);
        line.y.push_back(pose(pair).p[up]);
      }
      panel.marks.push_back(std::move(line));
    };
    add(0, longest->compared, [](const PosePair& pair) { return pair.ground_truth; });
    for (std::size_t i = 0; i < scored.scores.size(); ++i) {
      add(i + 1, scored.scores[i].compared, [](const PosePair& pair) { return pair.estimate; });
    }
    figure.panels.push_back(std::move(panel));
  }
  figure.alike = true;
  if (axes.front().first == kTime) {
    figure.height_mm = 128.0;
  } else {
    figure.columns = 3;
  }
  figure.caption = scored.caption;
  return figure;
}

}  // namespace

Figure error_figure(const ScoredTrajectories& scored) {
  Figure figure;
  Panel translation{{time_label(scored)}, {"translation error [m]"}, {}};
  Panel rotation{{time_label(scored)}, {"rotation error [deg]"}, {}};
  for (std::size_t i = 0; i < scored.scores.size(); ++i) {
    figure.series.push_back({scored.names[i]});
    PoseErrors errors = absolute_errors(scored.scores[i].compared);
    std::vector<double> times;
    for (const PosePair& pair : scored.scores[i].compared) times.push_back(pair.t);
    translation.marks.push_back({Mark::Kind::line, i, times, std::move(errors.trans_m)});
    rotation.marks.push_back({Mark::Kind::line, i, std::move(times), std::move(errors.rot_deg)});
  }
  figure.panels = {std::move(translation), std::move(rotation)};
  figure.height_mm = 96.0;
  figure.caption = scored.caption;
  return figure;
}

Figure position_figure(const ScoredTrajectories& scored) {
  return figure_of_trajectories(scored, {{kTime, 0}, {kTime, 1}, {kTime, 2}});
}

Figure trajectory_figure(const ScoredTrajectories& scored) {
  return figure_of_trajectories(scored, {{0, 1}, {0, 2}, {1, 2}});
}

Figure error_figure(std::span<const RunRecord> runs, const FigureOptions& options) {
  return error_figure(
      score_first_sequence(runs, FigureRuns(runs, options.causal), options, "Error of each pose after alignment"));
}

Figure position_figure(std::span<const RunRecord> runs, const FigureOptions& options) {
  return position_figure(
      score_first_sequence(runs, FigureRuns(runs, options.causal), options, "Position over time, after alignment"));
}

Figure trajectory_figure(std::span<const RunRecord> runs, const FigureOptions& options) {
  return trajectory_figure(score_first_sequence(runs, FigureRuns(runs, options.causal), options,
                                                "Trajectories after alignment, from three sides"));
}

}  // namespace evbench
