#include "bench/sweep/plan.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <chrono>
#include <iterator>
#include <set>

#include "bench/sweep/draw.hpp"
#include "bench/sweep/process_pool.hpp"
#include "core/io/sha256.hpp"
#include "core/plugin/write_options.hpp"
#include "core/support/error.hpp"
#include "core/support/interruption.hpp"
#include "core/support/json.hpp"
#include "core/support/nearest.hpp"

namespace evbench {
namespace {

/// A point of a grid: its overrides of the config, its values on the axes, and what is drawn for it.
struct Point {
  std::vector<std::string> overrides;
  RunAxes axes;
  std::vector<std::pair<std::string, Json>> draws;  ///< with their places in the file
};

std::vector<Point> points_of(const Grid& grid) {
  std::vector<Point> points(1);
  for (const ZippedAxes& zipped : grid) {
    std::vector<Point> finer;
    for (const Point& point : points) {
      for (std::size_t i = 0; i < zipped.front().values.size(); ++i) {
        Point& next = finer.emplace_back(point);
        for (const Axis& axis : zipped) {
          const AxisValue& value = axis.values[i];
          next.overrides.insert(next.overrides.end(), value.overrides.begin(), value.overrides.end());
          next.axes.emplace_back(axis.name, value.text);
          if (!value.draw.is_null()) {
            next.draws.emplace_back(fmt::format("{}.{}.draw", axis.name, value.text), value.draw);
          }
        }
      }
    }
    points = std::move(finer);
  }
  return points;
}

/// Whether overrides set any of these keys, a part of it, or what it is a part of.
bool sets_any(const std::vector<std::string>& overrides, const std::vector<std::string>& keys) {
  return std::ranges::any_of(overrides, [&](const std::string& override) {
    const std::string set = override.substr(0, override.find('='));
    return std::ranges::any_of(keys, [&](const std::string& key) {
      return key == set || key.starts_with(set + ".") || set.starts_with(key + ".");
    });
  });
}

/// Makes the plan, run by run.
class Planner {
 public:
  Planner(const Sweep& sweep, const Plugins& plugins)
      : sweep_(sweep), plugins_(plugins), config_(sweep.config, plugins) {}

  SweepPlan plan() {
    for (const Grid& grid : sweep_.grids) {
      for (const Point& point : points_of(grid)) gather(point);
    }
    with_place([&] {
      look_at_sources();
      for (auto& [config, axes] : gathered_) add(std::move(config), std::move(axes));
    });
    share_what_is_made_of_events(plan_.runs, plugins_,
                                 [&](const Job& job) { return !sources_.at(source_of(job)).events.empty(); });
    return std::move(plan_);
  }

 private:
  /// Adds the sweep to an error.
  template <class Work>
  void with_place(const Work& work) const {
    try {
      work();
    } catch (const Interrupted&) {
      throw;
    } catch (const InputError& error) {
      if (sweep_.place == sweep_.config) throw;
      throw InputError(fmt::format("{}: {}", sweep_.place, error.what()));
    }
  }

  void gather(const Point& point) {
    check_interruption();
    std::vector<std::string> overrides = sweep_.overrides;
    overrides.insert(overrides.end(), point.overrides.begin(), point.overrides.end());
    if (!sweep_.name.empty()) overrides.push_back("name=" + sweep_.name);
    RunAxes axes = point.axes;
    with_place([&] {
      draw_into(overrides, axes, point);
      const Experiment experiment = config_.experiment(overrides, "the sweep's");
      plan_.name = experiment.name;
      if (plan_.remarks.empty()) plan_.remarks = experiment.remarks;
      for (const RunConfig& config : experiment.runs) gathered_.emplace_back(config, axes);
    });
    for (const auto& [axis, value] : axes) note(axis, value);
  }

  /// Adds what is drawn at random for a point, by its seed, to its overrides and axes. What the point and the command
  /// line set themselves stays.
  void draw_into(std::vector<std::string>& overrides, RunAxes& axes, const Point& point) {
    std::vector<std::pair<std::string, Json>> draws = point.draws;
    if (!sweep_.draw.is_null()) draws.emplace(draws.begin(), "draw", sweep_.draw);
    if (draws.empty()) return;
    const std::uint64_t seed = config_.experiment(overrides, "the sweep's").runs.front().job.seed;
    std::vector<std::string> all;
    for (const auto& [place, items] : draws) {
      Drawn drawn = draw(items, seed, place);
      std::ranges::move(drawn.overrides, std::back_inserter(all));
      for (auto& [name, text, keys] : drawn.properties) {
        if (sets_any(overrides, keys)) continue;  // it would be shown at a wrong value
        if (std::ranges::find(axes, name, &RunAxes::value_type::first) != axes.end()) {
          throw InputError(
              fmt::format("{}.{}: an axis or another property is called so; expected another name", place, name));
        }
        axes.emplace_back(std::move(name), std::move(text));
      }
    }
    overrides.insert(overrides.begin(), all.begin(), all.end());
  }

  void add(RunConfig config, RunAxes axes) {
    check_interruption();
    JobIdentity identity = identify(config.job, sources_.at(source_of(config.job)), plugins_, digests_);
    PlannedRun run{std::move(config), std::move(identity), std::move(axes), "", "", {}};
    const auto [twin, is_new] = by_key_.emplace(run.identity.key, plan_.runs.size());
    if (!is_new) check_twin(plan_.runs[twin->second], run);
    const std::string place = fmt::format("{} {} {}", run.identity.key, run.config.label, place_of(run.axes));
    if (places_.insert(place).second) plan_.runs.push_back(std::move(run));  // grids may overlap
  }

  /// A job with several places in the sweep has one run, which is in tables at each place, under its label there. It
  /// can have only one protocol.
  static void check_twin(const PlannedRun& a, const PlannedRun& b) {
    if (write_options(a.config.evaluation) == write_options(b.config.evaluation)) return;
    throw InputError(fmt::format(
        "the runs \"{}\" ({}) and \"{}\" ({}) are the same job, {}, and differ in their protocol, of which a run has "
        "one; expected \"evaluation\" to be no axis: evbench score DIR --protocol NAME, or --set evaluation.KEY=VALUE, "
        "scores a sweep again",
        a.config.label, place_of(a.axes), b.config.label, place_of(b.axes), a.identity.key));
  }

  static std::string source_of(const Job& job) {
    return fmt::format("{} {}", job.seed, dump_json(job.source.with_type()));
  }

  /// Makes each source once, to learn the files that it reads. This is done in a separate process, so that a source
  /// that crashes or hangs does not end the sweep without a message. If that happens, each source gets its own process,
  /// to find which one it was.
  void look_at_sources() {
    std::map<std::string, const Job*> jobs;
    std::vector<const Job*> all;
    for (const auto& [config, axes] : gathered_) {
      if (jobs.emplace(source_of(config.job), &config.job).second) all.push_back(&config.job);
    }
    if (all.empty() || look_at(all).empty()) return;
    for (const Job* job : all) {
      if (const std::string reason = look_at({job}); !reason.empty()) {
        throw InputError(fmt::format("{}: its process ended when the source was made: {}", job->source.place, reason));
      }
    }
  }

  /// Why the process ended before it was done; empty: it was done.
  std::string look_at(const std::vector<const Job*>& jobs) {
    static const std::string kCantBeMade = "refused: ";  // begins the process' report of a source that can't be made
    const auto work = [&]() -> std::string {
      Json list = Json::array();
      try {
        for (const Job* job : jobs) {
          const SourceFiles files = *make_source(*job, plugins_);
          list.push_back({{"files", files.files}, {"events", files.events}});
        }
      } catch (const InputError& error) {
        return kCantBeMade + error.what();
      }
      return dump_json(list);
    };
    RunLimits limits = sweep_.limits;
    limits.seconds *= static_cast<double>(jobs.size());
    pool_.start(0, work, limits);
    std::vector<Ending> endings;
    while (endings.empty()) {
      check_interruption();
      endings = pool_.wait(std::chrono::milliseconds(50));
    }
    const Ending& ending = endings.front();
    if (ending.report.starts_with(kCantBeMade)) throw InputError(ending.report.substr(kCantBeMade.size()));
    if (ending.report.empty()) {
      return ending.log.empty() ? ending.reason : fmt::format("{}; it said: {}", ending.reason, ending.log.back());
    }
    const Json list = parse_json(ending.report);
    for (std::size_t i = 0; i < jobs.size(); ++i) {
      SourceFiles& files = sources_[source_of(*jobs[i])];
      files.files = list.at(i).at("files").get<std::vector<std::string>>();
      files.events = list.at(i).at("events").get<std::vector<std::string>>();
    }
    return "";
  }

  void note(const std::string& axis, const std::string& value) {
    auto found = std::ranges::find(plan_.axes, axis, &decltype(plan_.axes)::value_type::first);
    if (found == plan_.axes.end()) found = plan_.axes.insert(found, {axis, {}});
    if (std::ranges::find(found->second, value) == found->second.end()) found->second.push_back(value);
  }

  const Sweep& sweep_;
  const Plugins& plugins_;
  ConfigFile config_;
  Digests digests_;
  std::vector<std::pair<RunConfig, RunAxes>> gathered_;
  std::map<std::string, SourceFiles> sources_;
  std::map<std::string, std::size_t> by_key_;
  std::set<std::string> places_;
  SweepPlan plan_;
  ProcessPool pool_;
};

}  // namespace

std::string place_of(const RunAxes& axes) {
  std::string text;
  for (const auto& [axis, value] : axes) text += fmt::format("{}{}={}", text.empty() ? "" : ", ", axis, value);
  return text;
}

Json SweepPlan::to_json() const {
  Json json = {{"name", name}, {"axes", Json::array()}, {"runs", Json::array()}};
  for (const auto& [axis, values] : axes) json["axes"].push_back({{"name", axis}, {"values", values}});
  for (const PlannedRun& run : runs) {
    Json at = Json::object();
    for (const auto& [axis, value] : run.axes) at[axis] = value;
    json["runs"].push_back({{"key", run.identity.key}, {"label", run.config.label}, {"axes", std::move(at)}});
  }
  return json;
}

SweepPlan plan_sweep(const Sweep& sweep, const Plugins& plugins) { return Planner(sweep, plugins).plan(); }

void share_what_is_made_of_events(std::vector<PlannedRun>& runs, const Plugins& plugins,
                                  const std::function<bool(const Job&)>& events_in_files) {
  std::map<std::string, std::set<std::string>> jobs;  // jobs that need the same events or tracks
  for (PlannedRun& run : runs) {
    const PluginConfig& frontend = run.config.job.frontend;
    if (!plugins.of<FrontEnd>().find(frontend.type, frontend.place + ".type").reads_events) continue;
    Json job = parse_json(run.identity.text);
    job.erase("backend");
    job.erase("trajectory_rate");
    run.tracks = sha256(dump_json(job)).substr(0, 10);
    jobs[run.tracks].insert(run.identity.key);
    if (events_in_files(run.config.job)) continue;
    run.events = sha256(dump_json(Json({{"seed", job["seed"]}, {"source", job["source"]}}))).substr(0, 10);
    jobs[run.events].insert(run.identity.key);
  }
  for (PlannedRun& run : runs) {
    for (std::string* shared : {&run.tracks, &run.events}) {
      if (!shared->empty() && jobs[*shared].size() == 1) shared->clear();
    }
  }
}

std::vector<PlannedRun> select_runs(const SweepPlan& plan, const std::vector<std::string>& only) {
  std::map<std::string, std::set<std::string>> wanted;
  for (const std::string& text : only) {
    const std::size_t equals = text.find('=');
    const std::string name = text.substr(0, equals);
    std::vector<std::string> names;
    for (const auto& axis : plan.axes) names.push_back(axis.first);
    const auto axis = std::ranges::find(plan.axes, name, &decltype(plan.axes)::value_type::first);
    if (axis == plan.axes.end()) {
      throw InputError(fmt::format("--only {}: expected AXIS=VALUE; no axis is called \"{}\"{}", text, name,
                                   suggestion(name, names)));
    }
    if (equals == std::string::npos) {
      throw InputError(
          fmt::format("--only {}: expected AXIS=VALUE, with one of {}", text, fmt::join(axis->second, ", ")));
    }
    const std::string value = text.substr(equals + 1);
    if (std::ranges::find(axis->second, value) == axis->second.end()) {
      throw InputError(fmt::format("--only {}: the axis \"{}\" has no such value, but {}", text, name,
                                   fmt::join(axis->second, ", ")));
    }
    wanted[name].insert(value);
  }
  std::vector<PlannedRun> runs;
  for (const PlannedRun& run : plan.runs) {
    const bool chosen = std::ranges::all_of(wanted, [&](const auto& axis) {
      return std::ranges::any_of(
          run.axes, [&](const auto& at) { return at.first == axis.first && axis.second.contains(at.second); });
    });
    if (chosen) runs.push_back(run);
  }
  return runs;
}

}  // namespace evbench
