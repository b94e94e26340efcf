#include <filesystem>

#include "bench/sweep/plan.hpp"
#include "bench/testing/keys.hpp"
#include "bench/testing/sweeps.hpp"
#include "core/support/error.hpp"
#include "core/support/json.hpp"
#include "core/testing/catch2.hpp"

using namespace evbench;
using namespace evbench::testing;
using Catch::Matchers::ContainsSubstring;

namespace {

SweepPlan plan(const TemporaryFolder& folder, const std::string& file, const std::vector<std::string>& over = {}) {
  Plugins plugins = known_plugins();
  return plan_sweep(read_sweep(folder.file(file), {}, over, plugins), known_plugins());
}

std::vector<std::string> places(const std::vector<PlannedRun>& runs) {
  std::vector<std::string> result;
  for (const PlannedRun& run : runs) result.push_back(run.config.label + ": " + place_of(run.axes));
  return result;
}

const char* const kSweepFile = R"({
  "name": "both", "config": "c.json", "set": {"source.duration": 0.5},
  "axes": [{"name": "motion", "overlays": {"slow": {"source.motion.period": 6}, "fast": {"source.motion.period": 2}}}],
  "grids": [
    {"axes": [{"name": "back-end", "overlays": {"asynchronous": {"backend": {"type": "gp_map"}}}}]},
    {"axes": [{"name": "back-end", "overlays": {"frames": {"backend": {"type": "bundle_adjustment", "label": "BA"}}}},
              {"zip": [{"key": "backend.batch_duration", "name": "frame", "values": [0.1, 0.2]},
                       {"key": "backend.window", "values": [10, 5]}]}]}
  ]})";

}  // namespace

TEST_CASE("A sweep is the product of its axes, grid by grid, and its plan names each run's values") {
  const TemporaryFolder folder;
  folder.write("c.json", dump_json(tiny_config()));
  folder.write("sweep.json", kSweepFile);
  const SweepPlan made = plan(folder, "sweep.json");
  CHECK(made.name == "both");
  CHECK(places(made.runs) == std::vector<std::string>{
                                 "gp_map: motion=slow, back-end=asynchronous",
                                 "gp_map: motion=fast, back-end=asynchronous",
                                 "BA: motion=slow, back-end=frames, frame=0.1, backend.window=10",
                                 "BA: motion=slow, back-end=frames, frame=0.2, backend.window=5",
                                 "BA: motion=fast, back-end=frames, frame=0.1, backend.window=10",
                                 "BA: motion=fast, back-end=frames, frame=0.2, backend.window=5",
                             });
  CHECK(made.runs[3].config.job.source.options.at("duration") == 0.5);
  CHECK(made.runs[3].config.job.source.options.at("motion").at("period") == 6.0);
  CHECK(made.runs[3].config.job.backend.options.at("window") == 5);
  const Json json = made.to_json();
  REQUIRE(json.at("axes").size() == 4);
  CHECK(json.at("axes")[1] == Json{{"name", "back-end"}, {"values", {"asynchronous", "frames"}}});
  REQUIRE(json.at("runs").size() == 6);
  CHECK(json.at("runs")[0].at("axes") == Json{{"motion", "slow"}, {"back-end", "asynchronous"}});
  CHECK(json.at("runs")[5].at("key") == made.runs[5].identity.key);
  CHECK(json.at("runs")[5].at("label") == "BA");

  CHECK(select_runs(made, {"frame=0.1", "motion=fast"}).size() == 1);
  CHECK(select_runs(made, {"frame=0.1", "frame=0.2"}).size() == 4);
  CHECK_THROWS_WITH(select_runs(made, {"motoin=fast"}), ContainsSubstring("did you mean \"motion\"?"));
  CHECK_THROWS_WITH(select_runs(made, {"motion=fats"}), ContainsSubstring("has no such value, but slow, fast"));
  CHECK_THROWS_WITH(select_runs(made, {"motion"}), ContainsSubstring("expected AXIS=VALUE, with one of slow, fast"));
}

TEST_CASE("The same config has the same key in a sweep as alone, and points of one job are one run, or refused") {
  const TemporaryFolder folder;
  const std::string path = folder.write("c.json", dump_json(tiny_config()));
  const SweepPlan made = plan(folder, "c.json", {"seed=1,2"});
  CHECK(made.name == "tiny");
  CHECK(made.runs.at(0).identity.key == key_of(read_experiment(path, {}, known_plugins()).runs[0]));
  CHECK(made.runs.at(1).identity.key == key_of(read_experiment(path, {"seed=2"}, known_plugins()).runs[0]));
  const SweepPlan same = plan(folder, "c.json", {"backend.batch_duration=0.1,0.10"});
  CHECK(same.runs.at(0).identity.key == same.runs.at(1).identity.key);
  CHECK_THROWS_WITH(plan(folder, "c.json", {"evaluation.alignment=se3,sim3"}),
                    ContainsSubstring("evaluation.alignment=se3") && ContainsSubstring("differ in their protocol"));
}

TEST_CASE("An invalid sweep is refused before anything is written, with place and nearest name", "[slow]") {
  const TemporaryFolder folder;
  folder.write("c.json", dump_json(tiny_config()));
  const auto refused = [&](const std::string& sweep, const std::string& message) {
    folder.write("s.json", sweep);
    INFO(sweep);
    CHECK_THROWS_WITH(plan(folder, "s.json"), ContainsSubstring("s.json: ") && ContainsSubstring(message));
  };
  refused(R"({"config": "c.json", "axis": []})", "unknown key \"axis\"; did you mean \"axes\"?");
  refused(R"({"config": "d.json"})", "d.json: no such file");
  refused(R"({"config": "c.json", "axes": [{"key": "backend.batch_durations", "values": [1]}]})",
          "unknown key \"batch_durations\"; did you mean \"batch_duration\"? (from the sweep's "
          "backend.batch_durations=1)");
  refused(R"({"config": "c.json", "axes": [{"key": "seed", "values": []}]})",
          "axes.0: the axis \"seed\" has no values");
  refused(R"({"config": "c.json", "axes": [{"key": "seed", "values": [1]}, {"key": "seed", "values": [1]}]})",
          "expected one axis for a key");
  refused(R"({"config": "c.json", "axes": [{"key": "seed", "values": [1]}, {"name": "seed", "overlays": {"a": {}}}]})",
          "two axes are called \"seed\"");
  refused(R"({"config": "c.json", "axes": [{"key": "backend.batch_duration", "values": [0.1]}],
              "grids": [{"axes": [{"name": "which", "overlays": {"a": {"backend": {"type": "gp_map"}}}}]}]})",
          "the axis \"which\" sets \"backend\", and with it \"backend.batch_duration\"");
  refused(R"({"axes": [{"key": "seed", "values": [1]}]})", "\"config\" is missing");
  refused(R"({"config": "c.json", "grids": [{"axes": [{"key": "seed"}]}]})", "grids.0.axes.0: expected one of");
  refused(R"({"config": "c.json", "plugins": ["no.so"]})", "plugins: ");
  refused(R"({"config": "c.json", "timeout": -1})", "timeout: ");
  refused("{", "is not JSON");
  for (const auto& [arguments, message] :
       std::map<std::string, std::string>{{"sweep c.json --vary sede=1", "did you mean \"seed\"?"},
                                          {"sweep c.json --vary seed=1 --only seed=2", "has no such value"},
                                          {"sweep c.json --vary seed=1 --out c.json", "c.json/tiny: can't be made"},
                                          {"status .", "no sweep.json in it"},
                                          {"task c.json 5", "has 1 lines; expected a line 5"},
                                          {"task c.json 1", "is no run of a sweep's manifest"}}) {
    const Outcome outcome = testing::evbench(folder, arguments);
    INFO(arguments);
    CHECK(outcome.exit_code == (arguments.find("--out") == std::string::npos ? 2 : 4));
    CHECK_THAT(outcome.err, ContainsSubstring(message));
  }
  const Outcome slurm = testing::shell(folder, "PATH=/nowhere:/bin \"$evbench\" sweep c.json --executor slurm");
  if (!std::filesystem::exists("/bin/sbatch")) {
    CHECK(slurm.exit_code == 2);
    CHECK_THAT(slurm.err, ContainsSubstring("there is no sbatch"));
  }
}

TEST_CASE("What is drawn for a run depends on its seed alone, is a column, and gives way to what is set") {
  const TemporaryFolder folder;
  folder.write("c.json", dump_json(tiny_config()));
  folder.write("drawn.json", R"({
    "config": "c.json",
    "draw": {"pace": {"slow": {"source.motion.period": {"uniform": [6, 9]}}, "fast": {"source.motion.period": 2}},
             "source.tracks.noise": {"log_uniform": [0.1, 1]}},
    "axes": [{"name": "kind", "overlays": {"a": {}, "b": {"draw": {"source.tracks.alive": {"whole": [20, 40]}}}}},
             {"key": "seed", "range": {"from": 0, "to": 3}}]})");
  const SweepPlan made = plan(folder, "drawn.json");
  REQUIRE(made.runs.size() == 8);
  std::map<std::string, int> paces;
  for (std::size_t i = 0; i < 4; ++i) {
    const Json &a = made.runs[i].config.job.source.options, &b = made.runs[i + 4].config.job.source.options;
    CHECK(a.at("motion") == b.at("motion"));
    CHECK(a.at("tracks").at("noise") == b.at("tracks").at("noise"));
    CHECK(a.at("tracks").at("alive") == tiny_config().at("source").at("tracks").value("alive", 100));
    CHECK(b.at("tracks").at("alive") <= 40);
    const auto pace = std::ranges::find(made.runs[i].axes, "pace", &RunAxes::value_type::first);
    REQUIRE(pace != made.runs[i].axes.end());
    CHECK((pace->second == "fast") == (a.at("motion").at("period") == 2.0));
    ++paces[pace->second];
  }
  CHECK(paces == std::map<std::string, int>{{"fast", 2}, {"slow", 2}});
  CHECK(select_runs(made, {"pace=fast"}).size() == 4);
  folder.write("extended.json", R"({"base": "drawn.json", "set": {"source.tracks.noise": 0.5},
    "axes": [{"key": "backend.batch_duration", "values": [0.1, 0.2]}]})");
  const SweepPlan extended = plan(folder, "extended.json");
  CHECK(extended.runs.size() == 16);
  for (const PlannedRun& run : extended.runs) CHECK(run.config.job.source.options.at("tracks").at("noise") == 0.5);
  CHECK(extended.runs[0].config.job.source.options.at("motion") == made.runs[0].config.job.source.options.at("motion"));
  folder.write("wrong.json", R"({"config": "c.json", "draw": {"seed": {"uniform": [2, 1]}}})");
  CHECK_THROWS_WITH(plan(folder, "wrong.json"), ContainsSubstring("wrong.json: draw.seed"));
  folder.write("loop.json", R"({"base": "extended.json"})");
  CHECK_THROWS_WITH(plan(folder, "loop.json"), ContainsSubstring("without a base of its own"));
}

TEST_CASE("What the command line sets is refused where an axis would set it again") {
  const TemporaryFolder folder;
  folder.write("c.json", dump_json(tiny_config()));
  folder.write("s.json", R"({"config": "c.json",
                             "axes": [{"name": "which", "overlays": {"a": {"backend": {"type": "gp_map"}}}}]})");
  Plugins plugins = known_plugins();
  const auto read = [&](const std::vector<std::string>& overrides, const std::vector<std::string>& over) {
    return read_sweep(folder.file("s.json"), overrides, over, plugins);
  };
  CHECK_THROWS_WITH(read({"backend.qc_scale=2"}, {}),
                    ContainsSubstring("--set backend.qc_scale=2: the axis \"which\" of ") &&
                        ContainsSubstring("sets \"backend\" afterwards, and it would be lost"));
  CHECK_THROWS_WITH(read({"seed=3"}, {"seed=1..2"}), ContainsSubstring("--set seed=3: the axis \"seed\""));
  CHECK_NOTHROW(read({"seed=3", "frontend.sigma=1"}, {"backend.qc_scale=1,2"}));
}

TEST_CASE("A sweep does missing runs: those of a new value, damaged ones on request, and none for a new name",
          "[long]") {
  const TemporaryFolder folder;
  folder.write("c.json", dump_json(tiny_config()));
  const auto sweep = [&](const std::string& arguments) {
    return testing::evbench(folder, "sweep c.json " + arguments);
  };
  const Outcome planned = sweep("--vary seed=1..2 --dry-run");
  CHECK(planned.exit_code == 0);
  CHECK_THAT(planned.out, ContainsSubstring("seed=1\n") && ContainsSubstring("2 runs, 2 to do"));
  CHECK_FALSE(std::filesystem::exists(folder.file("results")));

  const Outcome first = sweep("--vary seed=1..2");
  CHECK(first.exit_code == 0);
  CHECK_THAT(first.out, ContainsSubstring("results/tiny: 2 runs, 0 of them done before, 0 failed"));
  const auto before = results_of(folder.file("results/tiny"));
  CHECK_THAT(sweep("--vary seed=1..3").out, ContainsSubstring("3 runs, 2 of them done before"));
  CHECK_THAT(sweep("--vary seed=1..3 --set name=other").out,
             ContainsSubstring("results/other: 3 runs, 3 of them done before"));
  CHECK_THAT(sweep("--vary seed=1..3 --set evaluation.rpe_delta=0.2").out, ContainsSubstring("3 of them done before"));
  CHECK_THAT(sweep("--vary seed=1..2").out, ContainsSubstring("2 of them done before"));
  CHECK_THAT(testing::evbench(folder, "status results").out,
             ContainsSubstring("results/other: 3 of 3 done") &&
                 ContainsSubstring("results/tiny: 2 of 2 done, 0 failed") &&
                 ContainsSubstring("that the sweep does not plan, and tables pass over: 1\n"));

  // The file of a config and evbench run give the same; the index lists the runs of a folder, here fewer.
  REQUIRE(testing::evbench(folder, "run c.json --quiet --out alone").exit_code == 0);
  for (const auto& [path, content] : results_of(folder.file("alone/tiny"))) {
    if (path != "index.csv") CHECK(before.at(path) == content);
  }

  // Both report the same damage.
  REQUIRE(testing::shell(folder, "rm -r results/other; rm results/tiny/*/final.tum").exit_code == 0);
  const Outcome damaged = sweep("--vary seed=1..2");
  CHECK(damaged.exit_code == 3);
  CHECK_THAT(damaged.err, ContainsSubstring("damaged: ") && ContainsSubstring("final.tum: is missing"));
  CHECK_THAT(damaged.out, ContainsSubstring("2 failed"));
  CHECK_THAT(sweep("--vary seed=1..2 --dry-run").out, ContainsSubstring("2 runs, 0 to do, 2 broken off or damaged"));
  CHECK_THAT(testing::evbench(folder, "status results").out, ContainsSubstring("0 of 2 done, 2 failed"));
  REQUIRE(sweep("--vary seed=1..2 --retry-failed").exit_code == 0);
  for (const std::string damage : {"truncate -s 100 $f/final.tum", "rm $f/status.json", "echo > $f/job.json"}) {
    INFO(damage);
    REQUIRE(testing::shell(folder, "for f in results/tiny/*-*; do " + damage + "; done").exit_code == 0);
    CHECK_THAT(testing::evbench(folder, "status results").out, ContainsSubstring("0 of 2 done, 2 failed"));
    CHECK_THAT(sweep("--vary seed=1..2").out, ContainsSubstring("2 failed"));
    REQUIRE(sweep("--vary seed=1..2 --retry-failed").exit_code == 0);
    CHECK(testing::evbench(folder, "status results").exit_code == 0);
  }
  CHECK(sweep("--vary seed=1..2 --retry-failed").exit_code == 0);
  auto after = results_of(folder.file("results/tiny"));
  for (const auto& [path, content] : before) {
    INFO(path);
    if (path == "index.csv") continue;               // a run of seed 3 is there now
    CHECK(after.at(path).size() == content.size());  // the log notes a change of protocol or name
  }
}

TEST_CASE("Two processes share a sweep, and lines of its manifest, done one by one, give the same bytes", "[slow]") {
  const TemporaryFolder folder;
  folder.write("c.json", dump_json(tiny_config()));
  REQUIRE(testing::evbench(folder, "sweep c.json --vary seed=1..6 --out one").exit_code == 0);
  const Outcome both = testing::shell(folder,
                                      "\"$evbench\" sweep c.json --vary seed=1..6 --out two > a & first=$!;"
                                      "\"$evbench\" sweep c.json --vary seed=1..6 --out two > b && wait $first");
  CHECK(both.exit_code == 0);
  CHECK_THAT(read_file(folder.file("a")), ContainsSubstring("6 runs"));
  CHECK_THAT(read_file(folder.file("b")), ContainsSubstring("6 runs"));
  const auto expected = results_of(folder.file("one/tiny"));
  CHECK(difference(expected, results_of(folder.file("two/tiny"))).empty());

  REQUIRE(testing::evbench(folder, "sweep c.json --vary seed=1..6 --out three --executor none").exit_code == 0);
  CHECK(testing::evbench(folder, "status three").exit_code == 3);
  const std::string task = "\"$evbench\" task three/tiny/manifest.jsonl ";
  CHECK_THAT(testing::evbench(folder, "score three").err, ContainsSubstring("none of these runs was done yet"));
  CHECK(testing::shell(folder, task + "1 --stride 2 && \"$evbench\" score three").exit_code == 0);  // of three runs
  CHECK(testing::shell(folder, task + "2 && " + task + "4 && " + task + "6").exit_code == 0);
  CHECK(testing::evbench(folder, "status three").exit_code == 0);
  auto made = results_of(folder.file("three/tiny"));
  made.erase("manifest.jsonl");
  CHECK(difference(expected, made).empty());
}

TEST_CASE(
    "Tracks from events are made once for back-ends that share them, with the same results, but not with feedback",
    "[slow]") {
  const TemporaryFolder folder;
  Json config = tiny_config();
  config.erase("backend");
  config["source"] = {{"type", "event_simulation"}, {"duration", 0.5}};
  config["frontend"] = {{"type", "haste"}, {"guidance", {{"outliers", false}, {"veto", false}, {"reacquire", false}}}};
  config["backends"] = {{{"type", "bundle_adjustment"}, {"label", "a"}, {"batch_duration", 0.1}},
                        {{"type", "bundle_adjustment"}, {"label", "b"}, {"batch_duration", 0.05}},
                        {{"type", "gp_map"}, {"label", "c"}}};
  folder.write("c.json", dump_json(config));
  testing::evbench(folder, "run c.json --quiet --out alone");  // whether or not so short a run has an estimate
  testing::evbench(folder, "sweep c.json --quiet --out shared");
  const auto expected = results_of(folder.file("alone/tiny"));
  CHECK(expected.size() > 30);
  auto shared = results_of(folder.file("shared/tiny"));
  shared.erase("sweep.json");
  CHECK(difference(expected, shared) == "");
  CHECK(names_in(folder.file("shared/.tracks")).size() == 1);

  // A damaged recording is not used, and tracks with feedback are not shared.
  REQUIRE(testing::shell(folder, "rm -r shared/tiny; f=$(ls shared/.tracks/*/*); head -c 50000 $f > x; mv x $f")
              .exit_code == 0);
  testing::evbench(folder, "sweep c.json --quiet --out shared");
  shared = results_of(folder.file("shared/tiny"));
  shared.erase("sweep.json");
  CHECK(difference(expected, shared) == "");
  testing::evbench(folder, "sweep c.json --quiet --out guided --set frontend.guidance.veto=true");
  CHECK(runs_of(folder.file("guided/tiny")).size() == 3);
  CHECK(names_in(folder.file("guided/.tracks")).empty());
}

TEST_CASE("Simulated events are made once for runs that share them, with the same results, and removed at the end",
          "[slow]") {
  const TemporaryFolder folder;
  Json config = tiny_config();
  config["source"] = {{"type", "event_simulation"}, {"duration", 0.3}};
  config["frontend"] = {{"type", "haste"}};  // guided
  folder.write("c.json", dump_json(config));
  const std::string sweep = "sweep c.json --quiet --vary backend.batch_duration=0.1,0.05 --vary frontend.tracks=40,60 ";
  const std::vector<PlannedRun> runs =
      plan(folder, "c.json", {"backend.batch_duration=0.1,0.05", "frontend.tracks=40,60"}).runs;
  for (const PlannedRun& run : runs) CHECK((!run.events.empty() && run.events == runs[0].events));
  CHECK(plan(folder, "c.json", {"seed=1,2"}).runs.at(0).events.empty());

  for (const char* const tracks : {"40", "60"}) {
    for (const char* const duration : {"0.1", "0.05"}) {
      testing::evbench(folder, fmt::format("run c.json --quiet --out own --set frontend.tracks={} "
                                           "--set backend.batch_duration={}",
                                           tracks, duration));
    }
  }
  const auto expected = results_of(folder.file("own/tiny"));
  CHECK(expected.size() > 40);
  const auto is_expected = [&](const std::string& out) {
    auto made = results_of(folder.file(out + "/tiny"));
    for (const char* const plan : {"sweep.json", "manifest.jsonl"}) made.erase(plan);
    CHECK(difference(expected, made) == "");
    CHECK_FALSE(std::filesystem::exists(folder.file(out + "/.events")));
  };
  testing::evbench(folder, sweep + "--out shared");
  is_expected("shared");

  // Tasks share them as well: later ones use those that the first one has made.
  REQUIRE(testing::evbench(folder, sweep + "--out tasks --executor none").exit_code == 0);
  const std::string task = "\"$evbench\" task tasks/tiny/manifest.jsonl ";
  testing::shell(folder, task + "1");
  const std::string recording = folder.file("tasks/.events/" + runs[0].events + "/events.evb");
  REQUIRE(std::filesystem::exists(recording));
  const auto made = std::filesystem::last_write_time(recording);
  testing::shell(folder, task + "2 & " + task + "3; wait");
  CHECK(std::filesystem::last_write_time(recording) == made);
  testing::shell(folder, task + "4");
  is_expected("tasks");

  // A damaged one is not used.
  REQUIRE(testing::shell(folder, "mkdir -p bad/.events/" + runs[0].events + " && echo no > bad/.events/" +
                                     runs[0].events + "/events.evb")
              .exit_code == 0);
  testing::evbench(folder, sweep + "--out bad");
  is_expected("bad");
}

TEST_CASE("A job that has two labels in a sweep is run once, and is in its table under both", "[slow]") {
  const TemporaryFolder folder;
  folder.write("c.json", dump_json(tiny_config()));
  folder.write("s.json", R"({"config": "c.json", "axes": [{"name": "which", "overlays": {
                           "one": {"backend.label": "first"}, "two": {"backend.label": "second"}}}]})");
  CHECK_THAT(testing::evbench(folder, "sweep s.json").out, ContainsSubstring("results/s: 1 runs"));
  CHECK_THAT(testing::evbench(folder, "table results/s").out,
             ContainsSubstring("first") && ContainsSubstring("second"));
}

TEST_CASE("The sweeps that come with evbench can be planned", "[slow]") {
  const TemporaryFolder folder;
  Json sweep = read_json(EVBENCH_SOURCE "/configs/sweeps/batching.json");
  sweep["config"] = EVBENCH_SOURCE "/configs/paper/table1_simulated.json";
  folder.write("batching.json", dump_json(sweep));
  const SweepPlan made = plan(folder, "batching.json");
  CHECK(made.runs.size() == 3 * 10 * (1 + 6 + 6 + 1));  // gp_map, batches by duration and by count, adaptive ones
  CHECK(made.axes.size() == 5);
}
