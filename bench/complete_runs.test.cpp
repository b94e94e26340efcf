#include <filesystem>
#include <stdexcept>

#include "bench/commands/commands.hpp"
#include "bench/run_folder.hpp"
#include "bench/testing/keys.hpp"
#include "bench/testing/program.hpp"
#include "core/io/sha256.hpp"
#include "core/support/error.hpp"
#include "core/support/json.hpp"
#include "core/testing/catch2.hpp"
#include "eval/find_runs.hpp"

using namespace evbench;
using namespace evbench::testing;
using Catch::Matchers::ContainsSubstring;

namespace {

/// A folder with the config c.json of the short comparison, and its runs.
struct Comparison {
  TemporaryFolder folder;
  Json config = short_comparison();

  Comparison() { write(); }
  void write() const { folder.write("c.json", dump_json(config)); }
  Outcome run(const std::string& arguments) const { return testing::evbench(folder, "run c.json " + arguments); }

  /// The run of this label below results/EXPERIMENT.
  std::string path(const std::string& label, const std::string& experiment = "short") const {
    for (const std::string& path : runs_of(folder.file("results/" + experiment))) {
      if (parse_json(read_file(path + "/metrics.json")).at("label") == label) return path;
    }
    FAIL("no run is labelled " << label);
    return "";
  }
  std::string content(const std::string& label, const std::string& name,
                      const std::string& experiment = "short") const {
    return read_file(path(label, experiment) + "/" + name);
  }
  Json metrics(const std::string& label, const std::string& experiment = "short") const {
    return parse_json(content(label, "metrics.json", experiment));
  }
  std::string sums() const {
    return testing::shell(folder, "cd results && find . -type f | sort | xargs sha256sum").out;
  }
};

/// Throws at its first observations.
class Breaking : public BackEnd {
 public:
  void advance(const UndistortedBatch& batch) override {
    if (!batch.observations.empty()) throw std::runtime_error("the matrix is singular");
  }
  BackEndFeedback feedback(const FeedbackNeeds&) override { return {}; }
  void finish() override {}
  Status status() const override { return {}; }
  PoseTrajectory trajectory() const override { return {}; }
  std::vector<Landmark> map() const override { return {}; }
};

/// The built-in plugins and one that throws as long as `breaks` is set, and is bundle adjustment afterwards.
Plugins plugins_with_breaking(const bool& breaks) {
  Plugins plugins = registered_plugins();
  Registry<BackEnd>::Entry entry = plugins.of<BackEnd>().find("bundle_adjustment", "test");
  const auto make = entry.make;
  entry.make = [&breaks, make](const Json& options, const BackEndContext& context) -> std::unique_ptr<BackEnd> {
    return breaks ? std::make_unique<Breaking>() : make(options, context);
  };
  plugins.of<BackEnd>().add("breaking", entry);
  return plugins;
}

/// `evbench run` in this process. Returns the exit code.
int run_here(Plugins& plugins, const std::string& arguments) {
  CLI::App app;
  int exit_code = 0;
  add_run(app, plugins, exit_code);
  app.parse("run " + arguments);
  return exit_code;
}

}  // namespace

TEST_CASE("Complete runs are not repeated except by --force, and are in the table all the same", "[slow]") {
  const Comparison comparison;
  const Outcome first = comparison.run("");
  REQUIRE(first.exit_code == 0);
  CHECK_THAT(first.out, !ContainsSubstring("complete already"));
  const std::string before = comparison.sums();
  const Outcome second = comparison.run("");
  CHECK(second.exit_code == 0);
  CHECK_THAT(second.out, ContainsSubstring("complete already: 2 of 2 (--force does them again)"));
  CHECK_THAT(second.out,
             ContainsSubstring("asynchronous") && ContainsSubstring("frames of 50 ms") && ContainsSubstring("ATE [m]"));
  CHECK(comparison.sums() == before);
  const Outcome forced = comparison.run("--force");
  CHECK_THAT(forced.out, !ContainsSubstring("complete already"));
  CHECK(comparison.sums() != before);  // measured times
}

TEST_CASE("Only the back-end that is added to a comparison is run", "[slow]") {
  Comparison comparison;
  REQUIRE(comparison.run("--quiet").exit_code == 0);
  const std::string timing = comparison.content("asynchronous", "timing.csv");
  comparison.config["backends"].push_back(
      {{"type", "bundle_adjustment"}, {"batch_duration", 0.1}, {"label", "100 ms"}});
  comparison.write();
  const Outcome more = comparison.run("");
  CHECK_THAT(more.out, ContainsSubstring("complete already: 2 of 3") && ContainsSubstring("100 ms"));
  CHECK(comparison.content("asynchronous", "timing.csv") == timing);
}

TEST_CASE("With another label or protocol, runs are relabelled and scored again without running", "[slow]") {
  Comparison comparison;
  REQUIRE(comparison.run("--quiet").exit_code == 0);
  const std::string path = comparison.path("asynchronous");
  const std::string timing = read_file(path + "/timing.csv"), trajectory = read_file(path + "/final.tum");
  comparison.config["backends"][0]["label"] = "mine";
  comparison.config["evaluation"]["alignment"] = "se3";
  comparison.write();
  const Outcome again = comparison.run("");
  CHECK_THAT(again.out, ContainsSubstring("complete already: 2 of 2") && ContainsSubstring("mine") &&
                            ContainsSubstring("SE(3) alignment"));
  CHECK(comparison.path("mine") == path);
  CHECK(read_file(path + "/timing.csv") == timing);
  CHECK(read_file(path + "/final.tum") == trajectory);
  CHECK_THAT(read_file(path + "/log.txt"), ContainsSubstring("relabelled short: mine"));
  const Json manifest = parse_json(read_file(path + "/manifest.json"));
  CHECK(manifest.at("config_sha256") == sha256_file(path + "/config.json"));
  // The same as a fresh run of that config.
  REQUIRE(comparison.run("--force --quiet").exit_code == 0);
  const Json fresh = comparison.metrics("mine");
  REQUIRE(comparison.run("--quiet --set evaluation.alignment=sim3").exit_code == 0);
  REQUIRE(comparison.run("--quiet").exit_code == 0);
  CHECK(dump_json(comparison.metrics("mine")) == dump_json(fresh));
}

TEST_CASE("The rows of a table are in the order of the config that was run last", "[slow]") {
  Comparison comparison;
  const auto rows = [&] {
    std::vector<std::string> labels;
    for (const RunRecord& run : find_runs(std::vector{comparison.folder.file("results")})) labels.push_back(run.label);
    return labels;
  };
  REQUIRE(comparison.run("--quiet").exit_code == 0);
  CHECK(rows() == std::vector<std::string>{"asynchronous", "frames of 50 ms"});
  REQUIRE(comparison.run("--quiet --set seed=2").exit_code == 0);
  CHECK(rows() == std::vector<std::string>{"asynchronous", "asynchronous", "frames of 50 ms", "frames of 50 ms"});
  std::swap(comparison.config["backends"][0], comparison.config["backends"][1]);
  comparison.write();
  const Outcome swapped = comparison.run("");
  CHECK_THAT(swapped.out, ContainsSubstring("complete already: 2 of 2"));
  CHECK(swapped.out.find("frames of 50 ms") < swapped.out.find("asynchronous"));
  REQUIRE(comparison.run("--quiet --set seed=2").exit_code == 0);
  CHECK(rows() == std::vector<std::string>{"frames of 50 ms", "frames of 50 ms", "asynchronous", "asynchronous"});
  const std::string config = "'" + comparison.path("asynchronous") + "/config.json'";
  REQUIRE(testing::evbench(comparison.folder, "run " + config + " --quiet").exit_code == 0);
  CHECK(rows().back() == "asynchronous");
}

TEST_CASE("Runs of several options and seeds are distinguished in their table", "[slow]") {
  const TemporaryFolder folder;
  folder.write("c.json", dump_json(short_config()));
  for (const std::string duration : {"0.1", "0.05"}) {
    for (const std::string seed : {"2", "1"}) {
      REQUIRE(testing::evbench(folder,
                               "run c.json --quiet --set seed=" + seed + " --set backend.batch_duration=" + duration)
                  .exit_code == 0);
    }
  }
  const std::string text = testing::evbench(folder, "table results").out;
  CHECK_THAT(text.substr(0, text.find('\n')),
             ContainsSubstring("backend.batch_duration  seed") && !ContainsSubstring("key"));
  const Outcome csv = testing::evbench(folder, "table results --format csv --metrics scale");
  std::vector<std::string> rows;
  std::istringstream lines(csv.out);
  for (std::string line; std::getline(lines, line);) rows.push_back(line.substr(0, line.find("bundle_adjustment-")));
  CHECK(rows[1] == "short,bundle_adjustment,0.05,1,");
  CHECK(rows[2] == "short,bundle_adjustment,0.05,2,");
  CHECK(rows[3] == "short,bundle_adjustment,0.1,1,");
  CHECK(rows[4] == "short,bundle_adjustment,0.1,2,");
}

TEST_CASE("A job that is complete in another experiment below the same folder is copied", "[slow]") {
  const Comparison comparison;
  REQUIRE(comparison.run("--quiet").exit_code == 0);
  const std::string before = comparison.content("asynchronous", "metrics.json");
  const Outcome other = comparison.run("--set name=other --set evaluation.alignment=se3");
  CHECK_THAT(other.out, ContainsSubstring("complete already: 2 of 2") && ContainsSubstring("Experiment: other."));
  CHECK(comparison.content("asynchronous", "timing.csv", "other") == comparison.content("asynchronous", "timing.csv"));
  const Json metrics = comparison.metrics("asynchronous", "other");
  CHECK(metrics.at("experiment") == "other");
  CHECK(metrics.at("final").at("alignment").at("method") == "se3");
  CHECK(comparison.content("asynchronous", "metrics.json") == before);
}

TEST_CASE("A run whose folder is damaged or of other data is repeated", "[long]") {
  const Comparison comparison;
  REQUIRE(comparison.run("--quiet").exit_code == 0);
  const std::string path = comparison.path("asynchronous");
  for (const char* name : {"job.json", "metrics.json", "final.tum"}) {
    INFO(name);
    std::filesystem::remove(path + "/" + name);
    CHECK_THAT(comparison.run("").out, ContainsSubstring("complete already: 1 of 2"));
    CHECK(std::filesystem::exists(path + "/" + name));
  }
}

TEST_CASE("A run is repeated if its problem is requested afterwards", "[slow]") {
  const Comparison comparison;
  REQUIRE(comparison.run("--quiet").exit_code == 0);
  REQUIRE(comparison.run("--quiet --problem").exit_code == 0);
  CHECK(std::filesystem::exists(comparison.path("asynchronous") + "/problem.txt"));
}

TEST_CASE("Two back-ends with the same job are an error with both labels, before anything is run") {
  Comparison comparison;
  comparison.config["backends"].push_back({{"type", "gp_map"}, {"label", "the same again"}});
  comparison.write();
  const Outcome outcome = comparison.run("");
  CHECK(outcome.exit_code == 2);
  CHECK_THAT(outcome.err,
             ContainsSubstring("c.json: the back-ends \"asynchronous\" and \"the same again\" are the same"));
  CHECK(names_in(comparison.folder.path()) == std::set<std::string>{"c.json"});
}

TEST_CASE("A back-end that throws makes its run failed with the reason, the others are run, and it is repeated",
          "[slow]") {
  const TemporaryFolder folder;
  Json config = short_comparison();
  config["backends"][0] = {{"type", "breaking"}, {"label", "mine"}};
  const std::string arguments = folder.write("c.json", dump_json(config)) + " --quiet --out " + folder.file("results");
  bool breaks = true;
  Plugins plugins = plugins_with_breaking(breaks);
  CHECK(run_here(plugins, arguments) == 3);
  const auto records = find_runs(std::vector{folder.file("results")});
  REQUIRE(records.size() == 2);
  const RunRecord& mine = records[0];
  CHECK(mine.label == "mine");
  CHECK(records[1].final_scores.is_object());
  REQUIRE(mine.status);
  CHECK(mine.status->status.state == RunState::failed);
  CHECK(mine.status->status.reason == "error: the matrix is singular");
  CHECK_FALSE(mine.status->complete);
  CHECK(parse_json(read_file(mine.folder + "/status.json")).at("complete") == false);
  CHECK_THAT(read_file(mine.folder + "/log.txt"), ContainsSubstring("error: the matrix is singular"));
  CHECK(mine.final_unscored == "no trajectory: error: the matrix is singular");
  CHECK(testing::evbench(folder, "score results --quiet").exit_code == 0);

  const std::string other = read_file(records[1].folder + "/timing.csv");
  breaks = false;
  CHECK(run_here(plugins, arguments) == 0);
  CHECK(read_record(mine.folder).status->complete);
  CHECK(read_file(records[1].folder + "/timing.csv") == other);
}

TEST_CASE("Ctrl-C leaves nothing of a run that is not complete", "[long]") {
  const TemporaryFolder folder;
  Json config = short_config("gp_map");
  config["source"]["duration"] = 3000;
  folder.write("c.json", dump_json(config));
  const Outcome outcome = testing::shell(folder, "timeout --preserve-status -s INT 2 \"$evbench\" run c.json");
  CHECK(outcome.exit_code == 130);
  CHECK(outcome.out.empty());
  CHECK(names_in(folder.path()) == std::set<std::string>{"c.json"});
}

TEST_CASE("An ended run keeps complete runs, prints their table, and continues from there", "[slow]") {
  const TemporaryFolder folder;
  Json config = short_comparison();
  config["source"]["duration"] = 60;
  config["backends"][0] = {{"type", "bundle_adjustment"}, {"label", "quick"}, {"batch_duration", 0.4}};
  config["backends"][1] = {{"type", "gp_map"}, {"label", "slow"}, {"placement", {{"rule", "rate"}, {"rate", 400}}}};
  folder.write("c.json", dump_json(config));
  const Outcome outcome = testing::shell(folder, R"(
    "$evbench" run c.json & until ls results/short/*/metrics.json > /dev/null 2>&1; do sleep 0.05; done
    kill -TERM $!; wait $!)");
  CHECK(outcome.exit_code == 143);
  CHECK_THAT(outcome.err, ContainsSubstring("c.json: interrupted; 1 of 2 runs are complete"));
  CHECK_THAT(outcome.out,
             ContainsSubstring("quick") && !ContainsSubstring("slow") && ContainsSubstring("written: results/short"));
  CHECK(runs_of(folder.file("results/short")).size() == 1);
}
