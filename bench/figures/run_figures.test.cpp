#include "bench/figures/run_figures.hpp"

#include <catch2/catch.hpp>

#include "bench/testing/program.hpp"
#include "core/support/error.hpp"
#include "eval/testing/runs.hpp"

using namespace evbench;
using namespace evbench::testing;
using Catch::Matchers::Contains;

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
      Json json = run("arm", "asynchronous", scores_with(0.01 * seed));
      json["seed"] = seed;
      add("asynchronous" + std::to_string(seed), json,
          {{"source", {{"type", "simulation"}}},
           {"frontend", {{"type", "oracle"}}},
           {"backend", {{"type", "gp_map"}}}});
    }
  }
};

}  // namespace

TEST_CASE("A sweep is a curve of medians with bands, and a level for what does not have the axis") {
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
  CHECK_THAT(figure.caption, Contains("arm. Medians, and bands between quartiles, of 3 seeds.") && Contains("Sim(3)"));
}

TEST_CASE("A map has the median ratio to the base on the same data, by two axes") {
  const Swept results;
  const FigureOptions options{
      .metrics = {"ate.trans_m.rmse"}, .axis = "backend.frame_duration", .across = "seed", .base = "asynchronous"};
  const Figure figure = map_figure(results.find(), options);
  const Mark& cells = mark_of(figure.panels.at(0), Mark::Kind::cells, 0);
  REQUIRE(cells.low.size() == 9);  // three frames, three seeds
  for (std::size_t i = 0; i < cells.low.size(); ++i) CHECK(cells.low[i] == Approx(100.0 * cells.x[i]));
  CHECK(figure.panels.at(0).title == "ATE [m]");
  CHECK_THAT(figure.caption, Contains("ATE [m] of bundle over that of asynchronous, on the same data"));
  FigureOptions other = options;
  other.base = "asynchron";
  CHECK_THROWS_WITH(map_figure(results.find(), other), Contains("did you mean \"asynchronous\"?"));
  other = options;
  other.across = "";
  CHECK_THROWS_WITH(map_figure(results.find(), other), Contains("expected --axis and --across"));
}

TEST_CASE("What failed is told above a sweep, behind a box's name, and by a profile") {
  Swept results;
  results.add_seed("bundle", 4, std::nullopt, 0.1);
  const std::vector<RunRecord> runs = results.find();
  const Figure sweep = sweep_figure(runs, {});
  const Mark& note = mark_of(sweep.panels.at(0), Mark::Kind::note, 1);
  CHECK(note.text == "1 fail");
  CHECK(note.x == std::vector{0.1});
  const Figure boxes = box_figure(runs, {});
  CHECK(boxes.panels.at(0).names.at(2) == "bundle, backend.frame_duration 0.1 (1 of 4 fail)");
  CHECK(mark_of(boxes.panels.at(0), Mark::Kind::box, 2).y.size() == 3);
}

TEST_CASE("A profile is of the data that all methods have runs of") {
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
  CHECK_THAT(figure.caption, Contains("over 3 sequences and seeds"));
}

TEST_CASE("Times are drawn of runs without scores, and what needs scores says so") {
  const Results results;
  results.add("a", run("arm", "no ground truth", nullptr));
  results.folder.write("a/timing.csv", "t_s,update_ms\n0.1,2.5\n0.2,3.5\n");
  const std::vector<RunRecord> runs = results.find();
  const Figure figure = times_figure(runs, {});
  CHECK(mark_of(figure.panels.at(0), Mark::Kind::line, 0).x.back() == 3.5);
  CHECK(figure.caption == "arm. Distribution of the times of all updates of all runs that succeeded.");
  CHECK_THROWS_WITH(position_figure(runs, {}), Contains("none of these runs has an estimate and ground truth"));
  CHECK_THROWS_WITH(error_figure(runs, {}), Contains("none of these runs has an estimate and ground truth"));
}

TEST_CASE("What can't be drawn is refused with what was expected") {
  const Swept results;
  const std::vector<RunRecord> runs = results.find();
  CHECK_THROWS_WITH(sweep_figure(runs, {.axis = "label"}),
                    Contains("has the value \"asynchronous\"; expected numbers"));
  CHECK_THROWS_WITH(sweep_figure(runs, {.axis = "backend.frame"}), Contains("backend.frame_duration"));
  CHECK_THROWS_WITH(profile_figure(runs, {.metrics = {"coverage"}}), Contains("neither lower nor higher is better"));
  Results one;
  one.add_seed("a", 1, 0.1);
  CHECK_THROWS_WITH(sweep_figure(one.find(), {}), Contains("differ in no number; expected runs of a sweep"));
}

TEST_CASE("Figures of runs are drawn by the program, the same bytes each time") {
  const TemporaryFolder folder;
  folder.write("c.json", short_comparison().dump());
  REQUIRE(testing::evbench(folder, "run c.json --quiet").exit_code == 0);
  for (const std::string kind : {"trajectory", "position", "error", "box", "times"}) {
    INFO(kind);
    const Outcome outcome =
        testing::evbench(folder, "figure " + kind + " results --out " + kind + ".svg --keep-script");
    INFO(outcome.err);
    REQUIRE(outcome.exit_code == 0);
    CHECK_THAT(read_file(folder.file(kind + ".svg")), Contains("<svg") && Contains("</svg>"));
  }
  const std::string svg = read_file(folder.file("trajectory.svg"));
  REQUIRE(shell(folder, "/usr/bin/python3 trajectory.py again.svg again.pdf").exit_code == 0);
  CHECK(read_file(folder.file("again.svg")) == svg);
  CHECK(read_file(folder.file("again.pdf")).starts_with("%PDF"));
}

TEST_CASE("Figures that can't be written or drawn are errors, and nothing is replaced") {
  const Swept results;
  const auto refused = [&](const std::string& arguments, const std::string& message) {
    const Outcome outcome = testing::evbench(results.folder, "figure sweep . " + arguments);
    CHECK(outcome.exit_code == 2);
    CHECK_THAT(outcome.err, Contains(message));
  };
  refused("--out f.jpg", "f.jpg: is no .svg, .pdf or .png");
  refused("--out f.svg --python /nowhere/python", "f.svg: could not be drawn: \"/nowhere/python\" can't be started");
  refused("--out f.svg --python /bin/false", "\"/bin/false\" ended with exit code 1");
  refused("--out f.svg --only seed=17", "none of 12 runs is left by --only");
  results.folder.write("f.svg", "mine");
  refused("--out f.svg", "f.svg: exists already");
  CHECK(read_file(results.folder.file("f.svg")) == "mine");
  for (const std::string& name : names_in(results.folder.path())) CHECK_FALSE(name.starts_with("f.svg.part"));
}

TEST_CASE("An option that says nothing of a kind of figure is refused") {
  const Swept results;
  const auto refused = [&](const std::string& arguments, const std::string& message) {
    const Outcome outcome = testing::evbench(results.folder, "figure " + arguments + " --out f.svg");
    INFO(arguments);
    CHECK(outcome.exit_code == 2);
    CHECK_THAT(outcome.err, Contains(message));
  };
  refused("box . --axis backend.frame_duration", "--axis says nothing of a figure of the kind box");
  refused("sweep . --across seed", "it takes --metrics, --axis, --axis-label, --online");
  refused("times . --online", "it takes none");
  CHECK(names_in(results.folder.path()).count("f.svg") == 0);
}
