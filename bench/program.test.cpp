#include "bench/testing/program.hpp"

#include <sstream>

#include "core/support/json.hpp"
#include "core/testing/catch2.hpp"

using namespace evbench;
using namespace evbench::testing;
using Catch::Matchers::ContainsSubstring;

namespace {

/// Names of the plugins of a kind, as `evbench list` prints them.
std::vector<std::string> listed(const std::string& text, const std::string& kind) {
  std::vector<std::string> names;
  std::istringstream lines(text);
  bool within = false;
  for (std::string line; std::getline(lines, line);) {
    if (!line.starts_with("  ")) {
      within = line == kind + ":";
    } else if (within) {
      names.push_back(line.substr(2, line.find(' ', 2) - 2));
    }
  }
  return names;
}

}  // namespace

TEST_CASE("Every command has help, and the program a version", "[slow]") {
  const TemporaryFolder folder;
  for (const char* command : {"", "run", "eval", "score", "table", "list", "describe", "solve", "info", "convert",
                              "dataset", "render", "new-plugin", "check-plugin"}) {
    const Outcome help = testing::evbench(folder, std::string(command) + " --help");
    INFO(command);
    CHECK(help.exit_code == 0);
    CHECK_THAT(help.out, ContainsSubstring("Usage:"));
    CHECK(help.err.empty());
  }
  CHECK_THAT(testing::evbench(folder, "--version").out, ContainsSubstring("evbench 1."));
  CHECK_THAT(testing::evbench(folder, "run --help").out,
             ContainsSubstring("--set") && ContainsSubstring("metrics.json"));
}

TEST_CASE("help prints what --help does, of all commands and of each") {
  const TemporaryFolder folder;
  for (const char* command : {"", "run", "dataset get", "completion"}) {
    INFO(command);
    const Outcome help = testing::evbench(folder, std::string("help ") + command);
    CHECK(help.exit_code == 0);
    CHECK(help.out == testing::evbench(folder, std::string(command) + " --help").out);
  }
}

TEST_CASE("All plugins are listed, and each is described for people and as a JSON Schema", "[slow]") {
  const TemporaryFolder folder;
  const std::string list = testing::evbench(folder, "list").out;
  for (const char* kind : {"source", "frontend", "backend"}) {
    const auto names = listed(list, kind);
    CHECK(names.size() >= 2);
    for (const std::string& name : names) {
      INFO(kind << " " << name);
      const Outcome described = testing::evbench(folder, std::string("describe ") + kind + " " + name);
      CHECK(described.exit_code == 0);
      CHECK_THAT(described.out, ContainsSubstring(name) && ContainsSubstring("option") && ContainsSubstring("default"));
      const Outcome schema = testing::evbench(folder, std::string("describe ") + kind + " " + name + " --schema");
      CHECK(parse_json(schema.out).at("type") == "object");
    }
  }
  CHECK_THAT(testing::evbench(folder, "describe config").out, ContainsSubstring("trajectory_rate"));
  CHECK(testing::evbench(folder, "describe gp_map").out == testing::evbench(folder, "describe backend gp_map").out);
  CHECK(parse_json(testing::evbench(folder, "describe config --schema").out).contains("$schema"));
}

TEST_CASE("An invalid command line ends with exit code 2 and a message", "[slow]") {
  const TemporaryFolder folder;
  folder.write("c.json", dump_json(short_config()));
  const auto refused = [&](const std::string& arguments, const std::string& message) {
    const Outcome outcome = testing::evbench(folder, arguments);
    INFO(arguments);
    CHECK(outcome.exit_code == 2);
    CHECK(outcome.out.empty());
    CHECK_THAT(outcome.err, ContainsSubstring(message));
  };
  refused("", "check-plugin");  // all commands
  refused("frobnicate", "\"frobnicate\" is no command; known: ");
  refused("runn c.json", "\"runn\" is no command; did you mean \"run\"?");
  refused("dataset lst", "\"lst\" is no command; did you mean \"list\"?");
  refused("run", "evbench run: config is required\nUsage: evbench run [OPTIONS] config\n");
  refused("run c.json --quite", "evbench run: there is no option --quite; did you mean \"--quiet\"?\nUsage: ");
  refused("run c.json --jobz=2", "there is no option --jobz; did you mean \"--jobs\"?");
  refused("eval --algin a b", "evbench eval: there is no option --algin; did you mean \"--align\"?");
  refused("sweep c.json --over seed=1", "there is no option --over");
  refused("dataset", "evbench dataset: expected a command: list, get, verify\nUsage: evbench dataset ");
  refused("dataset get --quiet=3 a b", "evbench dataset get: ");
  refused("table . --format txt", "evbench table: --format: \"txt\" is none of its names; did you mean \"text\"?");
  refused("help runn", "evbench help: \"runn\" is no command; did you mean \"run\"?");
  refused("help dataset gte", "did you mean \"get\"?");
  refused("describe backnd gp_map", "backnd");
  refused("describe backend", "expected config, a plugin's name");
  refused("describe gp_mop", "expected config, a plugin's name");
  refused("describe config gp_map", "expected no name");
  refused("describe backend gp_mop", "did you mean \"gp_map\"?");
  refused("table nowhere", "evbench table: nowhere: is not a folder");
  refused("table .", "no metrics.json");
  refused("run c.json --set seed", "expected KEY=VALUE");
  refused("run c.json --set seed=1 source.duration=2", "source.duration=2");
}

TEST_CASE("A run prints the table and the folder, and nothing with --quiet", "[slow]") {
  const TemporaryFolder folder;
  folder.write("c.json", dump_json(short_config()));
  const Outcome quiet = testing::evbench(folder, "run c.json --quiet");
  CHECK(quiet.out.empty());
  CHECK(quiet.err.empty());
  const Outcome usual = testing::evbench(folder, "run c.json");
  CHECK_THAT(usual.err, !ContainsSubstring("evbench"));  // only progress, a line every 10 s on a slow machine
  CHECK_THAT(usual.out, ContainsSubstring("ATE [m]") && ContainsSubstring("written: results/short"));
  const std::string text = testing::evbench(folder, "table results").out;
  CHECK_THAT(usual.out, ContainsSubstring(text));
  for (const char* format : {"markdown", "csv", "latex"}) {
    const Outcome table = testing::evbench(folder, std::string("table results --format ") + format);
    CHECK(table.exit_code == 0);
    CHECK_THAT(table.out, ContainsSubstring("bundle"));
  }
}

TEST_CASE("A watched run prints its progress on the standard error", "[slow]") {
  const TemporaryFolder folder;
  folder.write("c.json", dump_json(short_config()));
  const Outcome watched = testing::evbench(folder, "run c.json --watch");
  CHECK(watched.exit_code == 0);
  for (const char* const part : {"of 3.00 s", " tracks, ", " landmarks, ", " states, delay ", ", real-time factor "}) {
    CHECK_THAT(watched.err, ContainsSubstring(part));
  }
  CHECK_THAT(watched.out, ContainsSubstring("written: results/short") && !ContainsSubstring("delay "));
}

TEST_CASE("Runs done in parallel are the same as those done in turn", "[slow]") {
  const TemporaryFolder folder;
  folder.write("c.json", dump_json(short_comparison()));
  REQUIRE(testing::evbench(folder, "run c.json --quiet --problem --tracks --out one").exit_code == 0);
  const Outcome several = testing::evbench(folder, "run c.json --problem --tracks --out two -j 2");
  CHECK(several.exit_code == 0);
  CHECK_THAT(several.err, !ContainsSubstring("evbench"));  // only progress, as above
  CHECK(several.out.find("asynchronous") < several.out.find("frames of 50 ms"));
  CHECK_THAT(several.out, ContainsSubstring("ATE [m]") && ContainsSubstring("written: two/short"));
  REQUIRE(names_in(folder.file("one/short")) == names_in(folder.file("two/short")));
  for (const std::string& key : names_in(folder.file("one/short"))) {
    INFO(key);
    const std::string one = folder.file("one/short/" + key), two = folder.file("two/short/" + key);
    CHECK(names_in(one) == names_in(two));
    for (const char* file :
         {"/final.tum", "/causal.tum", "/causal_poses.txt", "/map.ply", "/tracks.txt", "/job.json"}) {
      CHECK(read_file(one + file) == read_file(two + file));
    }
  }
  CHECK_THAT(testing::evbench(folder, "run c.json -j 2 --out two").out, ContainsSubstring("complete already: 2 of 2"));
  const std::string before = read_file(*runs_of(folder.file("two/short")).begin() + "/timing.csv");
  CHECK(testing::evbench(folder, "run c.json -j 2 --out two --force --quiet").exit_code == 0);
  CHECK(read_file(*runs_of(folder.file("two/short")).begin() + "/timing.csv") != before);
}

TEST_CASE("The front-end recorded replays the tracks of a run", "[slow]") {
  const TemporaryFolder folder;
  Json config = short_config();
  config["source"]["tracks"]["dropout_rate"] = 2;
  folder.write("c.json", dump_json(config));
  REQUIRE(testing::evbench(folder, "run c.json --tracks --quiet --out first").exit_code == 0);
  const auto run = [&](const std::string& out) {
    const std::string experiment = folder.file(out + "/short");
    return *runs_of(experiment).begin();
  };
  config["frontend"] = {{"type", "recorded"}, {"tracks", run("first") + "/tracks.txt"}};
  config["frontend"]["ends"] = "ends.txt";
  const std::string tracks = read_file(run("first") + "/tracks.txt");
  const std::string id = tracks.substr(0, tracks.find(' ')),
                    begin = tracks.substr(id.size() + 1, tracks.find(' ', id.size() + 1) - id.size() - 1);
  const std::string early = id + " " + begin + "1\n";  // continues later
  folder.write("ends.txt", early + read_file(run("first") + "/track_ends.txt"));
  folder.write("again.json", dump_json(config));
  REQUIRE(testing::evbench(folder, "run again.json --tracks --quiet --out second").exit_code == 0);
  CHECK(read_file(run("second") + "/tracks.txt") == tracks);
  CHECK(read_file(run("second") + "/track_ends.txt") == read_file(folder.file("ends.txt")));
}

TEST_CASE("An override takes one value, so that the config may follow it") {
  const TemporaryFolder folder;
  folder.write("c.json", dump_json(short_config()));
  CHECK(testing::evbench(folder, "run --check --set seed=2 c.json").exit_code == 0);
}

TEST_CASE("Checking a config finds errors that would end a run at once", "[slow]") {
  const TemporaryFolder folder;
  write_recording(folder);
  CHECK(testing::evbench(folder, "run --check recording.json").exit_code == 0);
  const struct {
    const char* value;
    const char* message;
  } cases[] = {{"evaluation.time_range=[3,0]", "evaluation.time_range: is [3,0]; expected rising numbers"},
               {"source.time_range=[3,0]", "source.time_range: is [3,0]; expected rising numbers"},
               {"frontend.tracks=none.txt", "none.txt: no such file"},
               {"frontend.tracks=${EVBENCH_NOT_SET}/a.txt", "EVBENCH_NOT_SET"},
               {"source.folder=nowhere", "nowhere"},
               {"source={\"type\": \"recording\"}", "expected at least one of dataset, folder, events, calibration"},
               {"source={\"type\": \"recording\", \"dataset\": \"ecd/dynamic_6dof\"}", "evbench dataset get"}};
  for (const auto& [value, message] : cases) {
    INFO(value);
    const Outcome outcome =
        testing::shell(folder, "export EVBENCH_DATASETS=none; \"$evbench\" run --check recording.json --set '" +
                                   std::string(value) + "'");
    CHECK(outcome.exit_code == 2);
    CHECK_THAT(outcome.err, ContainsSubstring(message));
  }
}

TEST_CASE("Checking a config finds events that share no time with the ground truth", "[slow]") {
  const TemporaryFolder folder;
  write_recording(folder);
  folder.write("events.txt", "1400000000.1 5 7 1\n1400000000.2 6 8 0\n");
  const std::string events = R"( --set 'frontend={"type": "haste"}')",
                    check = "\"$evbench\" run --check recording.json";
  const Outcome apart = testing::shell(folder, check + events);
  CHECK(apart.exit_code == 2);
  CHECK_THAT(apart.err, ContainsSubstring("frontend: the recording has no events from") &&
                            ContainsSubstring("its first one is at 1400000000.100000 s"));
  CHECK(testing::shell(folder, check).exit_code == 0);  // tracks from a file: no events are read
  folder.write("events.txt", "0.1 5 7 1\n0.2 6 8 0\n");
  CHECK(testing::shell(folder, check + events).exit_code == 0);
}

TEST_CASE("A missing folder for temporary files is an error with its name", "[slow]") {
  const TemporaryFolder folder;
  folder.write("events.txt", "0.1 5 7 1\n0.2 6 8 0\n");
  const Outcome outcome = testing::shell(folder, "TMPDIR=no/folder \"$evbench\" render events.txt out.mp4");
  CHECK(outcome.exit_code == 4);
  CHECK_THAT(outcome.err, ContainsSubstring("TMPDIR: is \"no/folder\", which is no folder"));
}

TEST_CASE("Checking a config runs and writes nothing") {
  const TemporaryFolder folder;
  folder.write("c.json", dump_json(short_comparison()));
  const Outcome check = testing::evbench(folder, "run c.json --check");
  CHECK(check.exit_code == 0);
  CHECK_THAT(check.out, ContainsSubstring("c.json: fine, 2 runs"));
  CHECK(names_in(folder.path()) == std::set<std::string>{"c.json"});
}

TEST_CASE("An interrupted run leaves no partial files, and prints the table of complete runs", "[slow]") {
  const TemporaryFolder folder;
  Json config = short_config();
  config.erase("backend");
  config["backends"] = {{{"type", "bundle_adjustment"}, {"label", "frames"}},
                        {{"type", "process"}, {"label", "sleeps"}, {"command", {"sleep", "100"}}, {"timeout", 100}}};
  folder.write("c.json", dump_json(config));
  // Twice, as terminals, shells and `timeout` may do; not SIGINT, which a shell's background jobs ignore.
  const Outcome outcome = testing::shell(folder, R"("$evbench" run c.json & pid=$!
    until ls results/short/bundle_adjustment-*/metrics.json > /dev/null 2>&1; do sleep 0.1; done
    sleep 0.5; kill -TERM $pid; kill -TERM $pid; wait $pid)");
  CHECK(outcome.exit_code == 143);
  CHECK(outcome.err ==
        "evbench run: c.json: interrupted; 1 of 2 runs are complete, the same command continues from there\n");
  CHECK_THAT(outcome.out, ContainsSubstring("frames") && ContainsSubstring("ATE [m]") &&
                              ContainsSubstring("written: results/short"));
  CHECK(runs_of(folder.file("results/short")).size() == 1);
}

TEST_CASE("No command replaces its input, or writes two outputs to one file, even by --force", "[slow]") {
  const TemporaryFolder folder;
  write_recording(folder);
  folder.write("c.json", dump_json(short_config()));
  REQUIRE(testing::evbench(folder, "run c.json --quiet").exit_code == 0);
  REQUIRE(testing::shell(folder, "mv results/short/*/ run").exit_code == 0);
  const std::string before = testing::shell(folder, "sha256sum * run/* 2> /dev/null").out;
  for (const char* const command :
       {"eval groundtruth.txt groundtruth.txt --aligned groundtruth.txt",
        "eval run/groundtruth.tum run/final.tum --json run/final.tum", "export run --errors run/metrics.json",
        "table run --out run/metrics.json", "export c.json --tracks c.json",
        "export recording.json --groundtruth groundtruth.txt", "export recording.json --calib calib.txt"}) {
    INFO(command);
    const Outcome outcome = testing::evbench(folder, std::string(command) + " --force");
    CHECK(outcome.exit_code == 2);
    CHECK_THAT(outcome.err, ContainsSubstring("is also an input; expected another name"));
  }
  for (const char* const command : {"export c.json --groundtruth same.txt --tracks ./same.txt",
                                    "eval groundtruth.txt groundtruth.txt --errors same.txt --json same.txt"}) {
    INFO(command);
    const Outcome outcome = testing::evbench(folder, std::string(command) + " --force");
    CHECK(outcome.exit_code == 2);
    CHECK_THAT(outcome.err, ContainsSubstring("same.txt: is given as two outputs"));
  }
  CHECK(testing::shell(folder, "sha256sum * run/* 2> /dev/null").out == before);
}

TEST_CASE("A config may come from a pipe, with paths relative to the working folder") {
  const TemporaryFolder folder;
  write_recording(folder);
  const Outcome outcome = testing::shell(folder, "cat recording.json | \"$evbench\" run /dev/stdin --check");
  CHECK(outcome.err.empty());
  CHECK(outcome.exit_code == 0);
}

TEST_CASE("Runs that can't be read are reported after the table of the others", "[slow]") {
  const TemporaryFolder folder;
  folder.write("c.json", dump_json(short_comparison()));
  REQUIRE(testing::evbench(folder, "run c.json --quiet").exit_code == 0);
  REQUIRE(testing::shell(folder,
                         "cp -r results/short/gp_map-* a; cp -r a b; cp -r a results/c; : > a/metrics.json;"
                         "rm b/metrics.json; mv a b results")
              .exit_code == 0);
  for (const char* const command : {"table", "score"}) {
    const Outcome outcome = testing::evbench(folder, std::string(command) + " results");
    INFO(command);
    CHECK(outcome.exit_code == 2);
    CHECK_THAT(outcome.out, ContainsSubstring("asynchronous") && ContainsSubstring("frames of 50 ms"));
    CHECK_THAT(outcome.err, ContainsSubstring("a/metrics.json: is not JSON") &&
                                ContainsSubstring("b: is the folder of a run without"));
  }
}

TEST_CASE("Checking a config finds a folder for results that can't be written", "[slow]") {
  const TemporaryFolder folder;
  folder.write("c.json", dump_json(short_config()));
  CHECK(testing::evbench(folder, "run c.json --check --out new/folder").exit_code == 0);
  CHECK_FALSE(std::filesystem::exists(folder.file("new")));
  const Outcome outcome = testing::evbench(folder, "run c.json --check --out c.json/results");
  CHECK(outcome.exit_code == 4);
  CHECK_THAT(outcome.err, ContainsSubstring("c.json: is no folder; expected one for results"));
  const Outcome too_long = testing::evbench(folder, "run c.json --check --out new/" + std::string(256, 'n'));
  CHECK(too_long.exit_code == 4);
  CHECK_THAT(too_long.err, ContainsSubstring("nnn...: is too long for a folder"));
}
