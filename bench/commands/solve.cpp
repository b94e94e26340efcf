#include <fmt/format.h>

#include <cmath>
#include <map>
#include <memory>

#include "bench/commands/commands.hpp"
#include "bench/commands/number_check.hpp"
#include "core/io/atomic_file.hpp"
#include "core/smoother/cost.hpp"
#include "core/smoother/problem_solver.hpp"
#include "core/support/error.hpp"
#include "core/support/json.hpp"
#include "eval/quantile.hpp"

namespace evbench {
namespace {

const std::map<std::string, smoother::SolveMode> kModes = {{"incremental", smoother::SolveMode::incremental},
                                                           {"batch", smoother::SolveMode::batch},
                                                           {"fixed-lag", smoother::SolveMode::fixed_lag}};

struct SolveArguments {
  std::string problem, json, states, steps;
  bool check = false;
  smoother::SolveOptions options;
};

Json report(const SolveArguments& arguments, const smoother::SolveResult& result) {
  const smoother::Cost cost = evaluate(result.graph);
  if (!std::isfinite(cost.total())) throw InputError(arguments.problem + ": the solution's cost is not finite");
  Json json = {{"problem", arguments.problem},
               {"cost", cost.total()},
               {"cost_measurements", cost.measurements},
               {"cost_motion_prior", cost.motion_prior},
               {"cost_priors", cost.priors},
               {"steps", result.step_ms.size()},
               {"step_ms",
                {{"median", quantile_of(result.step_ms, 0.5)},
                 {"p95", quantile_of(result.step_ms, 0.95)},
                 {"p99", quantile_of(result.step_ms, 0.99)},
                 {"max", quantile_of(result.step_ms, 1.0)}}},
               {"total_s", result.total_s},
               {"peak_rss_mib", result.peak_mib}};
  if (!result.reason.empty()) json["reason"] = result.reason;
  if (arguments.check) json["relative_excess"] = check_against_batch(result.graph).relative_excess;
  return json;
}

/// STATE and LM records with the final estimate.
std::string format_states(const smoother::FactorGraph& graph) {
  Problem problem;
  problem.camera = graph.camera;
  problem.qc = graph.qc;
  problem.states = graph.states;
  return format_problem(problem);
}

std::string format_steps(const smoother::SolveResult& result) {
  std::string text = "step,ms,first_stage,stages,solved_back,linearised,damping,rejected\n";
  for (std::size_t k = 0; k < result.updates.size(); ++k) {
    const smoother::UpdateSummary& u = result.updates[k];
    text += fmt::format("{},{:.4f},{},{},{},{},{:g},{}\n", k, result.step_ms[k], u.first_stage, u.stages, u.solved_back,
                        u.linearised, u.damping, u.rejected ? 1 : 0);
  }
  return text;
}

void execute(const SolveArguments& arguments) {
  const smoother::SolveResult result = smoother::solve_problem(read_problem(arguments.problem), arguments.options);
  const Json json = report(arguments, result);
  fmt::print("{}\n", dump_json(json, 2));
  if (!arguments.json.empty()) write_file(arguments.json, dump_json(json, 2) + "\n");
  if (!arguments.states.empty()) write_file(arguments.states, format_states(result.graph));
  if (!arguments.steps.empty()) write_file(arguments.steps, format_steps(result));
}

}  // namespace

void add_solve(CLI::App& app) {
  auto arguments = std::make_shared<SolveArguments>();
  CLI::App* command = app.add_subcommand("solve", "Solve a problem file (gzip or not), time every step");
  command->add_option("problem", arguments->problem, "Problem file")->required()->type_name("FILE");
  command
      ->add_option("--mode", arguments->options.mode,
                   "incremental: one control state at a time; batch: all at once from the initial guess; fixed-lag: "
                   "incremental, states older than --lag are marginalised")
      ->transform(CLI::CheckedTransformer(kModes).description("{incremental,batch,fixed-lag}"))
      ->type_name("NAME")
      ->default_str("incremental");
  command->add_option("--json", arguments->json, "Also write the results to this file")->type_name("FILE");
  command->add_option("--states", arguments->states, "Write the final states as a problem's STATE records")
      ->type_name("FILE");
  command->add_option("--steps", arguments->steps, "Write a CSV with a line for each step")->type_name("FILE");
  command
      ->add_option("--reach", arguments->options.engine.reach,
                   "Number of states that relinearisation reaches back, at most")
      ->check(above_zero())
      ->capture_default_str();
  command->add_flag("--check", arguments->check, "Compare the cost with that of a batch solve from the result");
  command->add_option("--lag", arguments->options.lag, "Lag of fixed-lag mode [s]")
      ->check(above_zero())
      ->capture_default_str();
  command->add_option("--iterations", arguments->options.max_iterations, "Iterations of batch mode, at most")
      ->check(above_zero())
      ->capture_default_str();
  command
      ->add_option("--singer", arguments->options.motion_prior.rate,
                   "Singer's motion prior with this rate [1/s]; otherwise white noise on acceleration")
      ->check(above_zero());
  smoother::SmootherOptions& engine = arguments->options.engine;
  command->add_option("--relinearise", engine.relinearise, "Relinearise and redo from increments of this size [rad]")
      ->check(not_negative())
      ->capture_default_str();
  command
      ->add_option("--relinearise-redone", engine.relinearise_redone, "The same where stages are redone anyway [rad]")
      ->check(not_negative())
      ->capture_default_str();
  command
      ->add_option(
          "--solve-tolerance", engine.solve_tolerance,
          "Changes below this over the root of the number of landmarks alive are not solved back further [rad]")
      ->check(not_negative())
      ->capture_default_str();
  command->add_option("--check-step", engine.check_step, "Steps above this must not raise the cost [rad]")
      ->check(not_negative())
      ->capture_default_str();
  command->callback([arguments] { execute(*arguments); });
}

}  // namespace evbench
