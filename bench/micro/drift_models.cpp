// Compares models of trackers' drifting errors: the final problem of gp_map, its observations, states and prior, is
// solved in one batch under each model, starting from gp_map's estimate.
//
//   drift_models CONFIG [--set KEY=VALUE]... [--seeds N] [--drift PX --time S] [--true-noise]
//
// CONFIG's first back-end must be a gp_map. --drift adds an Ornstein-Uhlenbeck process of that size and correlation
// time to each track; --true-noise lets the models know what the simulator adds (source.tracks.noise and --drift, both
// in pixels), else they use estimates from the residuals of gp_map's estimate (track_noise.hpp). Models:
//
//   white        every observation counts in full, with noise as large as white and drifting part together
//   fewer        gp_map's own: an estimated share of the information (noise_learning.hpp)
//   one offset   an offset in the image a track
//   common part  an offset a window of twice the correlation time, each for itself
//   chain        a Gauss-Markov chain of offsets, one a correlation time
//   fine chain   likewise, four a correlation time
//   exact        likewise, one an observation
//
// The models with offsets also have white noise, which includes the drift that offsets over windows cannot follow.
// One row a model, medians over seeds: ATE and RPE as CONFIG scores, each with its ratio to that of "fewer", seed by
// seed (median, and Wilcoxon's p); normalised error of relative poses over 0.1 s and 1 s (1: as large as the covariance
// says; mean over seeds); variables, iterations, and processor time of an iteration.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <ctime>
#include <limits>
#include <string>
#include <vector>

#include "backends/gp_map/gp_map.hpp"
#include "bench/experiment.hpp"
#include "bench/micro/drift_problem.hpp"
#include "bench/micro/track_noise.hpp"
#include "core/plugin/registration.hpp"
#include "core/plugin/track_player.hpp"
#include "core/plugin/undistort.hpp"
#include "core/simulation/track_wander.hpp"
#include "core/support/error.hpp"
#include "core/support/median.hpp"
#include "eval/covariance_scores.hpp"
#include "eval/wilcoxon.hpp"

namespace {

using namespace evbench;
using smoother::FactorGraph;
using smoother::RobustLoss;

constexpr double kExchange = 0.01;  ///< [s]
constexpr double kLossWidth = 2.0;  ///< [sigmas], as gp_map has it
constexpr int kRelativePoses = 20;  ///< of a run whose covariance is evaluated, for each time distance

struct Arguments {
  std::string config;
  std::vector<std::string> overrides;
  int seeds = 10;
  double drift = 0.0, time = 0.3;
  bool true_noise = false;
};

/// A front-end's tracks without feedback.
std::vector<TrackObservation> tracks_of(const Job& job, const Source& source, const Plugins& plugins) {
  const auto& entry = plugins.of<FrontEnd>().find(job.frontend.type, job.frontend.place);
  const auto frontend = entry.make(job.frontend.options, {source, job.seed, job.folder, job.frontend.place});
  std::vector<TrackObservation> result;
  TrackBatch batch;
  for (bool more = true; more;) {
    more = frontend->advance({source.time_range().to}, batch);
    result.insert(result.end(), batch.observations.begin(), batch.observations.end());
  }
  return result;
}

/// gp_map's final problem, without the tracks that it rejects as outliers.
FactorGraph final_graph(const Job& job, const Camera& camera, const std::vector<TrackObservation>& observations,
                        const Plugins& plugins) {
  BackEndContext context;
  context.camera = camera.pinhole;
  context.seed = job.seed;
  const auto backend =
      plugins.of<BackEnd>().find(job.backend.type, job.backend.place).make(job.backend.options, context);
  const auto* gp_map = dynamic_cast<const gp_map::GpMap*>(backend.get());
  if (gp_map == nullptr) {
    throw InputError(fmt::format("{}: \"{}\" has no problem under a prior; expected gp_map as the first back-end",
                                 job.backend.place, job.backend.type));
  }
  TrackPlayer player(observations);
  TrackBatch batch;
  double t = observations.front().t;
  for (bool more = true; more; t += kExchange) {
    more = player.advance({t}, batch);
    backend->advance(undistort(batch, camera));
  }
  backend->finish();
  if (backend->trajectory().empty()) {
    throw InputError(fmt::format("{}: gp_map finds no initial map in these tracks, seed {}: {}", job.backend.place,
                                 job.seed, backend->status().reason));
  }
  return gp_map->graph();
}

/// A model of tracks' errors.
struct Errors {
  RobustLoss loss;
  DriftModel drift;
};

RobustLoss cauchy(double sigma) { return {RobustLoss::Kind::cauchy, kLossWidth * sigma, 1.0 / (sigma * sigma)}; }

Errors white(const FactorGraph&, const TrackNoise& noise) { return {cauchy(std::hypot(noise.white, noise.drift)), {}}; }

Errors fewer(const FactorGraph& graph, const TrackNoise&) {
  return {gp_map::learn_noise(graph).loss(RobustLoss::Kind::cauchy, kLossWidth), {}};
}

/// The drift's means over windows as offsets; the rest of it is modelled as white noise.
Errors windows(const TrackNoise& noise, double window, bool chained) {
  const double x = window / noise.time, lost = 1.0 - std::exp(-x);
  const double share = 2.0 * (x - lost) / (x * x);           // of the drift's variance, in its means
  const double correlation = lost * lost / (x * x * share);  // of neighbouring means
  const double time = chained ? -window / std::log(correlation) : 0.0;
  return {cauchy(std::hypot(noise.white, noise.drift * std::sqrt(1.0 - share))),
          {noise.drift * std::sqrt(share), window, time}};
}

Errors one_offset(const FactorGraph& graph, const TrackNoise& noise) {
  std::vector<double> lives;  // [s]
  for (const FactorGraph::Landmark& landmark : graph.landmarks) {
    if (landmark.intervals.empty()) continue;
    const double since = graph.states[index(landmark.intervals.front() - 1)].t;
    lives.push_back(graph.states[index(landmark.intervals.back())].t - since);
  }
  Errors result = windows(noise, median(std::move(lives)), false);
  result.drift.window = std::numeric_limits<double>::infinity();
  return result;
}

Errors common_part(const FactorGraph&, const TrackNoise& noise) { return windows(noise, 2.0 * noise.time, false); }
Errors chain(const FactorGraph&, const TrackNoise& noise) { return windows(noise, noise.time, true); }
Errors fine_chain(const FactorGraph&, const TrackNoise& noise) { return windows(noise, 0.25 * noise.time, true); }
Errors exact(const FactorGraph&, const TrackNoise& noise) {
  return {cauchy(noise.white), {noise.drift, 0.0, noise.time}};
}

struct Model {
  const char* name;
  Errors (*errors)(const FactorGraph& graph, const TrackNoise& noise);  ///< the noise in stated sigmas
};
constexpr std::array<Model, 7> kModels = {{{"white", white},
                                           {"fewer", fewer},
                                           {"one offset", one_offset},
                                           {"common part", common_part},
                                           {"chain", chain},
                                           {"fine chain", fine_chain},
                                           {"exact", exact}}};
constexpr std::size_t kFewer = 1;

PoseTrajectory sample(const FactorGraph& graph, double rate) {
  std::vector<StampedPose> poses;
  const double start = graph.states.front().t, end = graph.states.back().t;
  for (int i = 0; start + i / rate <= end; ++i) {
    const double t = start + i / rate;
    const int k = graph.interval_of(t);
    poses.push_back({t, graph.interval(k).pose(t)});
  }
  return PoseTrajectory(std::move(poses));
}

/// Relative poses over a time, spread evenly.
std::vector<RelativePose> relative_poses(const DriftProblem& problem, const DriftCovariance& covariance, double over) {
  const std::vector<ControlState>& states = problem.graph().states;
  std::vector<RelativePose> result;
  for (int n = 0; n < kRelativePoses; ++n) {
    const std::size_t i = static_cast<std::size_t>(n) * states.size() / kRelativePoses;
    const auto later = std::ranges::lower_bound(states, states[i].t + over, {}, &ControlState::t);
    if (later == states.end()) break;
    const int from = static_cast<int>(i), to = static_cast<int>(later - states.begin());
    if (const auto C = covariance.relative(from, to)) {
      result.push_back({"relative", states[i].t, later->t, states[i].T.inverse() * later->T, *C});
    }
  }
  return result;
}

/// One seed's run under one model.
struct Outcome {
  double ate = 0.0, rpe = 0.0;                         ///< [m]
  double nees_short = 0.0, nees = 0.0;                 ///< over 0.1 s and 1 s
  double variables = 0.0, iterations = 0.0, ms = 0.0;  ///< an iteration
};

Outcome solve(FactorGraph graph, const Errors& errors, const Source& source, const RunConfig& run) {
  graph.loss = errors.loss;
  DriftProblem problem(std::move(graph), errors.drift);
  const std::clock_t start = std::clock();
  const smoother::BatchSummary summary = problem.solve({50, 1e-6});
  Outcome result;
  const std::clock_t spent = std::clock() - start;
  if (!summary.failure.empty()) throw InputError(fmt::format("seed {}: {}", run.job.seed, summary.failure));
  result.variables = problem.unknowns();
  result.iterations = summary.iterations;
  result.ms = 1e3 * static_cast<double>(spent) / CLOCKS_PER_SEC / summary.iterations;
  const PoseTrajectory& truth = source.ground_truth();
  const Scores scores = score(truth, sample(problem.graph(), run.job.trajectory_rate), run.evaluation);
  result.ate = scores.ate.trans_m.rmse;
  result.rpe = scores.rpe.trans_m.rmse;
  const DriftCovariance covariance(problem);
  const double scale = scores.alignment.transform.scale;
  const auto nees = [&](double over) {
    return score_covariances(relative_poses(problem, covariance, over), truth, scale, 0.0).nees;
  };
  result.nees_short = nees(0.1);
  result.nees = nees(1.0);
  return result;
}

void report(const std::array<std::vector<Outcome>, kModels.size()>& outcomes) {
  const auto all = [](const std::vector<Outcome>& runs, double Outcome::*member) {
    std::vector<double> values;
    for (const Outcome& run : runs) values.push_back(run.*member);
    return values;
  };
  fmt::print(
      "| model | ATE [m] | / fewer | p | RPE [m] | / fewer | p | NEES 0.1 s | NEES 1 s | variables | iterations | "
      "iteration [ms] |\n| --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: |\n");
  for (std::size_t model = 0; model < kModels.size(); ++model) {
    const std::vector<Outcome>& own = outcomes[model];
    const auto error = [&](double Outcome::*member) {
      const std::vector<double> values = all(own, member), base = all(outcomes[kFewer], member);
      std::vector<double> ratios, logs;
      for (std::size_t i = 0; i < values.size(); ++i) {
        ratios.push_back(values[i] / base[i]);
        logs.push_back(std::log(ratios.back()));
      }
      return fmt::format("{:.6f} | {:.3f} | {:.2g}", median(values), median(ratios), signed_rank_test(logs).p);
    };
    const auto mean = [&](double Outcome::*member) {
      double sum = 0.0;
      for (const double value : all(own, member)) sum += value;
      return sum / static_cast<double>(own.size());
    };
    const auto middle = [&](double Outcome::*member) { return median(all(own, member)); };
    fmt::print("| {:<11} | {} | {} | {:.2f} | {:.2f} | {:.0f} | {:.0f} | {:.0f} |\n", kModels[model].name,
               error(&Outcome::ate), error(&Outcome::rpe), mean(&Outcome::nees_short), mean(&Outcome::nees),
               middle(&Outcome::variables), middle(&Outcome::iterations), middle(&Outcome::ms));
  }
}

void compare(const Arguments& arguments) {
  Plugins plugins;
  add_registered_plugins(plugins, kBuiltIn);
  std::array<std::vector<Outcome>, kModels.size()> outcomes;
  for (int seed = 1; seed <= arguments.seeds; ++seed) {
    std::vector<std::string> overrides = arguments.overrides;
    overrides.push_back(fmt::format("seed={}", seed));
    const RunConfig run = read_experiment(arguments.config, overrides, plugins).runs.front();
    const auto source = make_source(run.job, plugins);
    std::vector<TrackObservation> observations = tracks_of(run.job, *source, plugins);
    if (observations.empty()) {
      throw InputError(fmt::format("{}: its front-end makes no tracks; expected some", arguments.config));
    }
    const double stated = observations.front().noise.sigma();
    if (arguments.drift > 0.0) add_wander(observations, arguments.drift, arguments.time, Random(run.job.seed, 5));
    const FactorGraph graph = final_graph(run.job, source->camera(), observations, plugins);
    TrackNoise noise = estimate_noise(graph);
    if (arguments.true_noise) {
      const double sigma = std::hypot(stated, arguments.drift);
      noise = {stated / sigma, arguments.drift / sigma, arguments.time};
    }
    fmt::print(stderr, "seed {}: white {:.3f}, drift {:.3f} stated sigmas, {:.3f} s; {} states, {} observations\n",
               seed, noise.white, noise.drift, noise.time, graph.states.size(), graph.observation_count());
    for (std::size_t model = 0; model < kModels.size(); ++model) {
      outcomes[model].push_back(solve(graph, kModels[model].errors(graph, noise), *source, run));
    }
  }
  report(outcomes);
}

}  // namespace

int main(int argc, char** argv) {
  Arguments arguments;
  CLI::App app{"What a model of trackers' drifting errors is worth"};
  app.add_option("CONFIG", arguments.config, "whose first back-end is a gp_map")->required();
  app.add_option("--set", arguments.overrides, "KEY=VALUE, of the config")->allow_extra_args(false);
  app.add_option("--seeds", arguments.seeds, "1 to this many")->check(CLI::PositiveNumber);
  app.add_option("--drift", arguments.drift, "added to tracks [px]")->check(CLI::NonNegativeNumber);
  app.add_option("--time", arguments.time, "of its correlation [s]")->check(CLI::PositiveNumber);
  app.add_flag("--true-noise", arguments.true_noise, "models know what the simulator adds");
  CLI11_PARSE(app, argc, argv);
  try {
    compare(arguments);
  } catch (const std::exception& error) {
    fmt::print(stderr, "drift_models: {}\n", error.what());
    return 1;
  }
  return 0;
}
