#include "bench/figures/run_figures.hpp"

#include <filesystem>

#include "bench/run_folder.hpp"
#include "bench/testing/program.hpp"
#include "core/io/atomic_file.hpp"
#include "core/support/error.hpp"
#include "core/support/json.hpp"
#include "core/testing/catch2.hpp"
#include "eval/testing/runs.hpp"

using namespace evbench;
using namespace evbench::testing;
using Catch::Matchers::ContainsSubstring;

namespace {

const Mark& mark_of(const Panel& panel, Mark::Kind kind, std::size_t series) {
  const auto found =
      std::ranges::find_if(panel.marks, [&](const Mark& mark) { return mark.kind == kind && mark.series == series; });
  if (found == panel.marks.end()) throw std::runtime_error("the panel has no such mark");
  return *found;
}

/// A sweep of frames, and a back-end that has none.
struct Swept : Results {
  Swept() {
    for (int seed = 1; seed <= 3; ++seed) {
      for (const double frame : {0.2, 0.05, 0.1}) add_seed("bundle", seed, frame * seed, frame);
      add_asynchronous(seed, 0.01 * seed);
    }
  }
  /// Of an ATE; none: it failed.
  void add_asynchronous(int seed, std::optional<double> ate) const {
    Json json = run("arm", "asynchronous", ate ? scores_with(*ate) : Json(), ate ? "ok" : "failed");
    json["seed"] = seed;
    add("asynchronous" + std::to_string(seed), json,
        {{"source", {{"type", "simulation"}, {"motion", "arm"}}},
         {"frontend", {{"type", "oracle"}}},
         {"backend", {{"type", "gp_map"}}}});
  }
};

}  // namespace

TEST_CASE("A sweep is a curve of medians with bands, and a level for a method without the axis") {
  const Swept results;
  const Figure figure = sweep_figure(results.find(), {.metrics = {"ate.trans_m.rmse"}, .axis_label = "frame [s]"});
  REQUIRE(figure.series.size() == 2);
  CHECK(figure.series[0].label == "asynchronous");
  CHECK(figure.series[1].label == "bundle");
  const Panel& panel = figure.panels.at(0);
  CHECK(panel.x.label == "frame [s]");
  CHECK(panel.y.label == "ATE [m]");
  const Mark& curve = mark_of(panel, Mark::Kind::points, 1);
  CHECK(curve.x == std::vector{0.05, 0.1, 0.2});
  CHECK(curve.y == std::vector{0.1, 0.2, 0.4});
  CHECK(mark_of(panel, Mark::Kind::band, 1).high[2] == Approx(0.5));
  const Mark& level = mark_of(panel, Mark::Kind::level, 0);
  CHECK(level.y == std::vector{0.02});
  CHECK(level.low.at(0) == Approx(0.015));
  CHECK_THAT(figure.caption, ContainsSubstring("arm. Medians, and bands between quartiles, of 3 runs each (seed).") &&
                                 ContainsSubstring("Sim(3)"));
}

TEST_CASE("A map has the median ratio to the base on the same data, by two axes") {
  const Swept results;
  const FigureOptions options{
      .metrics = {"ate.trans_m.rmse"}, .axis = "backend.batch_duration", .across = "seed", .base = "asynchronous"};
  const Figure figure = map_figure(results.find(), options);
  const Mark& cells = mark_of(figure.panels.at(0), Mark::Kind::cells, 0);
  REQUIRE(cells.low.size() == 9);  // three frames, three seeds
  for (std::size_t i = 0; i < cells.low.size(); ++i) CHECK(cells.low[i] == Approx(100.0 * cells.x[i]));
  CHECK(figure.panels.at(0).title == "ATE [m]");
  CHECK_THAT(figure.caption, ContainsSubstring("ATE [m] of bundle over that of asynchronous, on the same data"));
  FigureOptions other = options;
  other.base = "asynchron";
  CHECK_THROWS_WITH(map_figure(results.find(), other), ContainsSubstring("did you mean \"asynchronous\"?"));
  other = options;
  other.across = "";
  CHECK_THROWS_WITH(map_figure(results.find(), other), ContainsSubstring("expected --axis and --across"));
}

TEST_CASE("Failed runs are shown above a sweep, behind a box's name, and in a profile") {
  Swept results;
  results.add_seed("bundle", 4, std::nullopt, 0.1);
  const std::vector<RunRecord> runs = results.find();
  const Figure sweep = sweep_figure(runs, {});
  const Mark& failures = mark_of(sweep.panels.at(0), Mark::Kind::failures, 1);
  CHECK(failures.x == std::vector{0.1});
  CHECK(failures.low == std::vector{1.0});
  CHECK(failures.high == std::vector{4.0});
  CHECK_THAT(sweep.caption, ContainsSubstring("of 3 to 4 runs each (seed). Above: how many of the runs failed"));
  const Figure boxes = box_figure(runs, {});
  CHECK(boxes.panels.at(0).names.at(2) ==
        "bundle, backend.batch_duration 0.1 (1\u00a0of\u00a04\u00a0fail)");  // not to be broken
  CHECK(boxes.panels.at(1).names.at(2).empty());                             // the first panel shows it
  CHECK_THAT(boxes.caption, ContainsSubstring("Those that failed are in no box."));
  CHECK(mark_of(boxes.panels.at(0), Mark::Kind::box, 2).y.size() == 3);
}

TEST_CASE("Failed runs of a level are shown, too") {
  const Swept results;
  results.add_asynchronous(4, std::nullopt);
  const Figure figure = sweep_figure(results.find(), {});
  const Mark& failures = mark_of(figure.panels.at(0), Mark::Kind::failures, 0);
  CHECK(failures.x.empty());
  CHECK(failures.low == std::vector{1.0});
  CHECK(failures.high == std::vector{4.0});
}

TEST_CASE("A value of the axis at which the median fails is in the figure", "[slow]") {
  const Results results;
  for (int seed = 1; seed <= 3; ++seed) {
    for (const double frame : {0.1, 0.2}) results.add_seed("bundle", seed, frame, frame);
    results.add_seed("bundle", seed, std::nullopt, 0.4);
  }
  const Outcome outcome = testing::evbench(results.folder, "figure sweep . --out f.svg --keep-script");
  INFO(outcome.err);
  REQUIRE(outcome.exit_code == 0);
  CHECK_THAT(outcome.err, !ContainsSubstring("warns"));
  CHECK_THAT(read_file(results.folder.file("f.svg")),
             ContainsSubstring("<!-- 0.4 -->") && ContainsSubstring("<!-- 3/3 -->"));
}

TEST_CASE("Two experiments in one box plot have different names") {
  const Results results;
  for (int seed = 1; seed <= 3; ++seed) {
    results.add_seed("mine", seed, 0.1 * seed);
    Json json = run("legs", "mine", scores_with(0.2));
    json["seed"] = seed;
    results.add(
        "legs" + std::to_string(seed), json,
        {{"seed", seed}, {"source", {{"type", "simulation"}, {"motion", "leg"}}}, {"backend", {{"type", "mine"}}}});
  }
  const Figure figure = box_figure(results.find(), {});
  REQUIRE(figure.series.size() == 2);
  CHECK(figure.series[0].label == "mine, experiment arm");
  CHECK(figure.series[1].label == "mine, experiment legs");
}

TEST_CASE("A sweep over a setting that labels also differ in is drawn with a remark") {
  const Results results;
  for (const double frame : {0.05, 0.1, 0.2}) {
    const std::string label = fmt::format("bundle {}", frame);
    results.add(label, run("arm", label, scores_with(frame)),
                {{"source", {{"type", "simulation"}}}, {"backend", {{"batch_duration", frame}}}});
  }
  const Figure figure = sweep_figure(results.find(), {.axis = "backend.batch_duration"});
  REQUIRE(figure.series.size() == 3);
  CHECK(mark_of(figure.panels.at(0), Mark::Kind::points, 0).x == std::vector{0.1});
  REQUIRE(figure.remarks.size() == 1);
  CHECK_THAT(figure.remarks[0], ContainsSubstring("Labels differ wherever backend.batch_duration does"));
  CHECK_THAT(figure.caption, ContainsSubstring(figure.remarks[0]));
  std::vector<RunRecord> one = results.find();
  for (RunRecord& run : one) run.label = "bundle";
  const Figure joined = sweep_figure(one, {});
  CHECK(joined.remarks.empty());
  CHECK(mark_of(joined.panels.at(0), Mark::Kind::points, 0).x.size() == 3);
  CHECK_THROWS_WITH(sweep_figure(results.find(), {.axis = "backend.frame"}),
                    ContainsSubstring("runs do not differ in \"backend.frame\""));
}

TEST_CASE("Panels of one figure are scaled alike, and an axis has ticks at both of its ends") {
  const Swept results;  // ATE from 0.05 to 0.6, RPE the same everywhere
  const Figure sweep = sweep_figure(results.find(), {.axis = "backend.batch_duration"});
  REQUIRE(sweep.panels.size() == 2);
  for (const Panel& panel : sweep.panels) {
    CHECK(panel.y.log);
    CHECK(panel.x.ends == std::vector{0.05, 0.2});
  }
  for (const Panel& panel : box_figure(results.find(), {}).panels) CHECK(panel.x.log);
  ScoredTrajectories scored{{"mine"}, {Scores()}, "arm."};
  CHECK(trajectory_figure(scored).alike);
  CHECK(position_figure(scored).alike);
  CHECK_FALSE(error_figure(scored).alike);
  CHECK(error_figure(scored).panels.at(0).y.label == "translation error [m]");
}

TEST_CASE("The caption has the part of the protocol that a figure depends on") {
  const Swept results;
  const std::vector<RunRecord> runs = results.find();
  const auto caption = [&](const std::vector<std::string>& metrics) {
    return box_figure(runs, {.metrics = metrics}).caption;
  };
  CHECK_THAT(caption({"ate.trans_m.rmse"}), ContainsSubstring("Sim(3)") && !ContainsSubstring("RPE"));
  CHECK_THAT(caption({"rpe.trans_m.rmse"}), ContainsSubstring("Sim(3)") && ContainsSubstring("RPE over 0.1 seconds"));
  CHECK_THAT(caption({"realtime_factor"}), !ContainsSubstring("Sim(3)") && !ContainsSubstring("Final"));
}

TEST_CASE("The caption says what runs that are drawn together differ in") {
  const Swept results;
  std::vector<RunRecord> runs = results.find();
  for (std::size_t i = runs.size(); i > 0; --i) {
    RunRecord& slow = runs.emplace_back(runs[i - 1]);
    slow.settings.emplace_back("source.speed", 0.5);
    slow.key += "-slow";
  }
  CHECK_THAT(sweep_figure(runs, {.axis = "backend.batch_duration"}).caption,
             ContainsSubstring("Medians, and bands between quartiles, of 6 runs each (source.speed, seed)."));
  CHECK_THAT(sweep_figure(runs, {.axis = "seed"}).caption,
             ContainsSubstring("quartiles, of 2 runs each (source.speed)."));
  CHECK_THAT(box_figure(runs, {}).caption, ContainsSubstring("as a point, of 6 runs each (source.speed, seed)."));
  CHECK_THAT(sweep_figure(results.find(), {.axis = "seed"}).caption, ContainsSubstring("arm. Each point is one run."));
}

TEST_CASE("A profile is of the data that all methods have runs on") {
  Results results;
  for (int seed = 1; seed <= 4; ++seed) results.add_seed("a", seed, 0.1);
  for (int seed = 1; seed <= 3; ++seed)
    results.add_seed("b", seed, seed == 1 ? std::nullopt : std::optional(0.05 * seed));
  const Figure figure = profile_figure(results.find(), {.metrics = {"ate.trans_m.rmse"}});
  const Mark& a = mark_of(figure.panels.at(0), Mark::Kind::steps, 0);
  const Mark& b = mark_of(figure.panels.at(0), Mark::Kind::steps, 1);
  CHECK(a.y.front() == Approx(1.0));  // b is as good once, and worse otherwise
  CHECK(b.y.front() == Approx(1.0 / 3.0));
  CHECK(b.y.back() == Approx(2.0 / 3.0));
  CHECK_THAT(figure.caption, ContainsSubstring("over 3 sequences and seeds"));
}

TEST_CASE("Times are drawn for runs without scores, and figures that need scores say so") {
  const Results results;
  results.add("a", run("arm", "no ground truth", nullptr));
  results.folder.write("a/timing.csv", "t_s,update_ms\n0.1,2.5\n0.2,3.5\n");
  const std::vector<RunRecord> runs = results.find();
  const Figure figure = times_figure(runs, {});
  CHECK(mark_of(figure.panels.at(0), Mark::Kind::line, 0).x.back() == 3.5);
  CHECK(figure.caption == "arm. Distribution of the times of all updates of all runs that succeeded.");
  CHECK_THROWS_WITH(position_figure(runs, {}),
                    ContainsSubstring("none of these runs has an estimate and ground truth"));
  CHECK_THROWS_WITH(error_figure(runs, {}), ContainsSubstring("none of these runs has an estimate and ground truth"));
}

TEST_CASE("What can't be drawn is refused with what was expected") {
  const Swept results;
  const std::vector<RunRecord> runs = results.find();
  CHECK_THROWS_WITH(sweep_figure(runs, {.axis = "label"}),
                    ContainsSubstring("has the value \"asynchronous\"; expected numbers"));
  CHECK_THROWS_WITH(sweep_figure(runs, {.axis = "backend.frame"}), ContainsSubstring("backend.batch_duration"));
  CHECK_THROWS_WITH(profile_figure(runs, {.metrics = {"coverage"}}),
                    ContainsSubstring("neither lower nor higher is better"));
  Results one;
  one.add_seed("a", 1, 0.1);
  CHECK_THROWS_WITH(sweep_figure(one.find(), {}), ContainsSubstring("differ in no number; expected runs of a sweep"));
}

TEST_CASE("Figures of runs are drawn by the program, the same bytes each time", "[slow]") {
  const TemporaryFolder folder;
  folder.write("c.json", dump_json(short_comparison()));
  REQUIRE(testing::evbench(folder, "run c.json --quiet").exit_code == 0);
  for (const std::string kind : {"trajectory", "position", "error", "box", "times"}) {
    INFO(kind);
    const Outcome outcome =
        testing::evbench(folder, "figure " + kind + " results --out " + kind + ".svg --keep-script");
    INFO(outcome.err);
    REQUIRE(outcome.exit_code == 0);
    CHECK_THAT(read_file(folder.file(kind + ".svg")), ContainsSubstring("<svg") && ContainsSubstring("</svg>"));
  }
  const std::string svg = read_file(folder.file("trajectory.svg"));
  CHECK_THAT(svg, ContainsSubstring("Sim(3)") && !ContainsSubstring("RPE"));
  REQUIRE(testing::evbench(folder, "figure trajectory results --out plain.svg --no-caption --labels asynchronous=Ours")
              .exit_code == 0);
  CHECK_THAT(read_file(folder.file("plain.svg")), ContainsSubstring("Ours") && !ContainsSubstring("Sim(3)"));
  REQUIRE(shell(folder, "/usr/bin/python3 trajectory.py again.svg again.pdf").exit_code == 0);
  CHECK(read_file(folder.file("again.svg")) == svg);
  CHECK(read_file(folder.file("again.pdf")).starts_with("%PDF"));
}

TEST_CASE("A figure of one sequence names it, and it and its exported data say why a run is missing", "[slow]") {
  const TemporaryFolder folder;
  Json config = short_comparison();
  config["source"]["duration"] = 1;
  config["backends"] = {{{"type", "bundle_adjustment"}, {"label", "a"}},
                        {{"type", "bundle_adjustment"}, {"label", "b"}, {"batch_duration", 0.1}}};
  folder.write("c.json", dump_json(config));
  for (const std::string alive : {"40", "50"}) {
    REQUIRE(testing::evbench(folder, "run c.json --quiet --set source.tracks.alive=" + alive).exit_code == 0);
  }
  std::string failed;
  for (const RunRecord& run : find_runs(std::vector{folder.path()})) {
    if (run.label != "b") continue;
    failed = run.folder;  // like a run that was stopped
    Json metrics = parse_json(read_file(run.folder + "/metrics.json"));
    metrics["status"]["state"] = "failed";
    metrics["status"]["reason"] = "timeout after 20 s";
    write_file(run.folder + "/metrics.json", dump_json(metrics));
    for (const char* estimate : {"/final.tum", "/causal.tum"}) write_file(run.folder + estimate, "");
    std::filesystem::remove(run.folder + "/groundtruth.tum");
    score_again(run.folder, protocol_of_run(run.folder));
  }
  std::vector<RunRecord> runs = find_runs(std::vector{folder.path()});
  CHECK_THAT(error_figure(runs, {}).caption,
             ContainsSubstring(
                 "after alignment, source.tracks.alive 40, seed 1 (the first of 2 sequences and seeds). b is not "
                 "drawn: no trajectory: timeout after 20 s. Final"));
  const Outcome outcome = testing::evbench(folder, "export '" + failed + "' --evo x.zip");
  CHECK(outcome.exit_code == 2);
  CHECK_THAT(outcome.err, ContainsSubstring("no trajectory: timeout after 20 s"));
  std::erase_if(runs, [](const RunRecord& run) { return run.label == "a"; });
  CHECK_THROWS_WITH(error_figure(runs, {}), ContainsSubstring("b is not drawn: no trajectory: timeout after 20 s."));
}

TEST_CASE("Runs selected by several values of one name have any of them", "[slow]") {
  const Swept results;
  const auto script_of = [&](const std::string& only) {
    const Outcome outcome =
        testing::evbench(results.folder, "figure sweep . --axis seed --out f.svg --keep-script --force " + only);
    INFO(outcome.err);
    REQUIRE(outcome.exit_code == 0);
    return read_file(results.folder.file("f.py"));
  };
  CHECK_THAT(script_of("--only seed=1 --only seed=3 --only label=asynchronous"), ContainsSubstring("\"x\":[1.0,3.0]"));
  CHECK_THAT(script_of("--only label=asynchronous"), ContainsSubstring("\"x\":[1.0,2.0,3.0]"));
}

TEST_CASE("Trajectories from elsewhere are drawn with their ground truth", "[slow]") {
  const TemporaryFolder folder;
  folder.write("c.json", dump_json(short_comparison()));
  REQUIRE(testing::evbench(folder, "run c.json --quiet").exit_code == 0);
  for (const std::string& run : runs_of(folder.file("results/short"))) {
    const std::string label = parse_json(read_file(run + "/metrics.json")).at("label");
    folder.write(label == "asynchronous" ? "a.tum" : "b.tum", read_file(run + "/final.tum"));
    folder.write("truth.tum", read_file(run + "/groundtruth.tum"));
  }
  for (const std::string kind : {"trajectory", "position", "error"}) {
    const Outcome outcome = testing::evbench(
        folder, "eval truth.tum a.tum b.tum -as --interpolate --plot " + kind + ".svg --plot_kind " + kind);
    INFO(outcome.err);
    REQUIRE(outcome.exit_code == 0);
    CHECK_THAT(outcome.out, ContainsSubstring("ATE [m]"));
    CHECK_THAT(read_file(folder.file(kind + ".svg")), ContainsSubstring("a.tum") && ContainsSubstring("b.tum") &&
                                                          ContainsSubstring("Sim(3)") && !ContainsSubstring("RPE") &&
                                                          !ContainsSubstring(folder.path()));
  }
  const Outcome refused = testing::evbench(folder, "eval truth.tum a.tum -as --plot error.svg");
  CHECK(refused.exit_code == 2);
  CHECK_THAT(refused.err, ContainsSubstring("error.svg: exists already"));
  CHECK_THAT(testing::evbench(folder, "eval truth.tum a.tum --plot f.jpg").err, ContainsSubstring("is no .svg"));
}

TEST_CASE("Python's warnings are passed on", "[slow]") {
  const Swept results;
  const Outcome outcome = testing::evbench(results.folder, "figure box . --out f.svg --width 20");
  CHECK(outcome.exit_code == 0);
  CHECK_THAT(outcome.err, ContainsSubstring("f.svg: is drawn, but Python warns:\n  constrained_layout not applied"));
}

TEST_CASE("Figures that can't be written or drawn are errors, and nothing is replaced", "[slow]") {
  const Swept results;
  const auto refused = [&](const std::string& arguments, const std::string& message) {
    const Outcome outcome = testing::evbench(results.folder, "figure sweep . " + arguments);
    CHECK(outcome.exit_code == 2);
    CHECK_THAT(outcome.err, ContainsSubstring(message));
  };
  refused("--out f.jpg", "f.jpg: is no .svg, .pdf or .png");
  refused("--out f.svg --python /nowhere/python", "f.svg: could not be drawn: \"/nowhere/python\" can't be started");
  refused("--out f.svg --python /bin/false", "\"/bin/false\" ended with exit code 1");
  refused("--out f.svg --only seed=17", "none of 12 runs is left by --only");
  const Outcome nowhere = testing::evbench(results.folder, "figure sweep . --out nowhere/f.svg");
  CHECK(nowhere.exit_code == 4);
  CHECK_THAT(nowhere.err, ContainsSubstring("evbench figure: nowhere/f.svg: can't be written: "));
  results.folder.write("f.svg", "mine");
  refused("--out f.svg", "f.svg: exists already");
  CHECK(read_file(results.folder.file("f.svg")) == "mine");
  for (const std::string& name : names_in(results.folder.path())) CHECK_FALSE(name.starts_with("f.svg.part"));
}

TEST_CASE("An option that does not apply to a kind of figure is refused") {
  const Swept results;
  const auto refused = [&](const std::string& arguments, const std::string& message) {
    const Outcome outcome = testing::evbench(results.folder, "figure " + arguments + " --out f.svg");
    INFO(arguments);
    CHECK(outcome.exit_code == 2);
    CHECK_THAT(outcome.err, ContainsSubstring(message));
  };
  refused("box . --axis backend.batch_duration", "--axis has no effect on a figure of the kind box");
  refused("sweep . --across seed", "it takes --metrics, --axis, --axis-label, --causal");
  refused("times . --causal", "it takes none");
  CHECK(names_in(results.folder.path()).count("f.svg") == 0);
}
