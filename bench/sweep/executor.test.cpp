#include <fcntl.h>
#include <signal.h>
#include <unistd.h>

#include <filesystem>
#include <stdexcept>
#include <thread>

#include "bench/run_folder.hpp"
#include "bench/sweep/local_executor.hpp"
#include "bench/sweep/sweep_status.hpp"
#include "bench/testing/keys.hpp"
#include "bench/testing/sweeps.hpp"
#include "core/plugin/registration.hpp"
#include "core/support/json.hpp"
#include "core/testing/catch2.hpp"
#include "eval/find_runs.hpp"
#include "eval/table.hpp"

using namespace evbench;
using namespace evbench::testing;
using Catch::Matchers::ContainsSubstring;

namespace {

/// A back-end that misbehaves once observations come.
class Troublemaker : public BackEnd {
 public:
  struct Options {
    std::string what = "crash", file;
    void declare(OptionSet& set) {
      set.add("what", what, "what it does").choices({"crash", "hang", "eat", "exit", "throw", "die once", "die"});
      set.add("file", file, "where it notes that it was here").folder();
    }
  };
  Troublemaker(const Options& options, const BackEndContext&) : options_(options) {}

  void advance(const UndistortedBatch& batch) override {
    if (batch.observations.empty()) return;
    const bool was_here = std::filesystem::exists(options_.file);
    if (!options_.file.empty()) ::close(::open(options_.file.c_str(), O_CREAT | O_WRONLY, 0644));
    if (options_.what == "crash") {
      std::puts("about to crash");
      std::fflush(stdout);
      ::signal(SIGSEGV, SIG_DFL);  // of a sanitizer
      ::raise(SIGSEGV);
    }
    if (options_.what == "hang") ::sleep(1000);
    if (options_.what == "eat") eat();
    if (options_.what == "exit") ::_exit(0);
    if (options_.what == "throw") throw std::runtime_error("no more");
    if (options_.what == "die" || (options_.what == "die once" && !was_here)) ::raise(SIGKILL);
  }
  BackEndFeedback feedback(const FeedbackNeeds&) override { return {}; }
  void finish() override {}
  Status status() const override { return {RunState::failed, "no estimate is made", 0.0, {}}; }
  PoseTrajectory trajectory() const override { return {}; }
  std::vector<Landmark> map() const override { return {}; }

 private:
  static void eat() {
    std::vector<char> memory(std::size_t{4000} << 20U);
    for (std::size_t i = 0; i < memory.size(); i += 4096) memory[i] = 1;
    ::sleep(1000);
  }

  Options options_;
};

const Registration<BackEnd, Troublemaker> registration("troublemaker", "does what no back-end should");

/// A source that crashes or hangs when it is made.
class TroubledSource : public Source {
 public:
  struct Options {
    std::string what = "crash";
    void declare(OptionSet& set) { set.add("what", what, "what it does").choices({"crash", "hang"}); }
  };
  TroubledSource(const Options& options, const SourceContext&) {
    std::puts("reading a strange file");
    std::fflush(stdout);
    ::signal(SIGSEGV, SIG_DFL);  // of a sanitizer
    if (options.what == "crash") ::raise(SIGSEGV);
    ::sleep(1000);
  }
  const Camera& camera() const override { return camera_; }
  TimeRange time_range() const override { return {}; }
  const PoseTrajectory& ground_truth() const override { return truth_; }

 private:
  Camera camera_;
  PoseTrajectory truth_;
};

const Registration<Source, TroubledSource> source_registration("troubled", "a source that can't be made");

std::vector<PlannedRun> runs_of(const TemporaryFolder& folder, const Json& config) {
  Plugins plugins = known_plugins();
  return plan_sweep(read_sweep(folder.write("c.json", dump_json(config)), {}, {}, plugins), known_plugins()).runs;
}

SweepProgress run(const std::vector<PlannedRun>& runs, const ExecutorOptions& options) {
  return do_runs(runs, known_plugins(), options, [](const SweepProgress&) {});
}

std::map<std::string, std::string> reasons(const SweepProgress& progress) {
  std::map<std::string, std::string> result;
  for (const TroubledRun& run : progress.troubled) result[run.label] = run.reason;
  return result;
}

}  // namespace

TEST_CASE("A source that crashes or hangs when it is made is reported by the sweep with a sentence", "[slow]") {
  const TemporaryFolder folder;
  Json config = tiny_config();
  config["source"] = {{"type", "troubled"}};
  CHECK_THROWS_WITH(runs_of(folder, config),
                    ContainsSubstring("source: its process ended when the source was made: killed by "
                                      "SIGSEGV; it said: reading a strange file"));
  config["source"]["what"] = "hang";
  folder.write("c.json", dump_json(config));
  folder.write("s.json", R"({"config": "c.json", "timeout": 0.3})");
  Plugins plugins = known_plugins();
  CHECK_THROWS_WITH(plan_sweep(read_sweep(folder.file("s.json"), {}, {}, plugins), plugins),
                    ContainsSubstring("timeout after 0.3 s"));
}

TEST_CASE("A plugin that crashes, hangs or eats memory ends only its own run, with the reason in the table", "[slow]") {
  const TemporaryFolder folder;
  Json config = tiny_config();
  config.erase("backend");
  config["backends"] = {{{"type", "bundle_adjustment"}, {"label", "fine"}, {"batch_duration", 0.1}}};
  for (const char* const what : {"crash", "hang", "eat", "exit", "throw", "die"}) {
    config["backends"].push_back({{"type", "troublemaker"}, {"label", what}, {"what", what}});
  }
  const std::vector<PlannedRun> runs = runs_of(folder, config);
  // Separate from the others, which have no time limit, so that a slow machine does not fail the test.
  const std::vector<PlannedRun> hangs = {runs[2]};
  CHECK(run(hangs, {folder.file("out"), 1, {0.3, 0.0}, false}).failed == 1);
  ExecutorOptions options{folder.file("out"), 2, {0.0, 1500.0}, false};
  const SweepProgress progress = run(runs, options);
  CHECK(progress.done == 7);
  CHECK(progress.failed == 6);
  auto reason = reasons(progress);
  CHECK(reason.at("crash") == "killed by SIGSEGV");
  CHECK(reason.at("hang") == "timeout after 0.3 s");
  CHECK_THAT(reason.at("eat"), ContainsSubstring("killed: ") && ContainsSubstring("GiB, limit 1.5 GiB"));
  CHECK(reason.at("exit") == "ended with exit code 0 before it was done");
  CHECK(reason.at("throw") == "error: no more");
  CHECK(reason.at("die") == "killed by SIGKILL");

  std::vector<RunRecord> records = find_runs(std::vector{folder.file("out")});
  REQUIRE(records.size() == 7);
  const std::string table = make_table(records, {});
  for (const auto& [label, text] : reason) CHECK_THAT(table, ContainsSubstring(text));
  for (const RunRecord& record : records) {
    CHECK(record.status->complete == (record.label == "fine"));
    const std::set<std::string> names = names_in(record.folder);
    for (const char* const name : {"config.json", "job.json", "metrics.json", "status.json", "log.txt"}) {
      CHECK(names.contains(name));
    }
    if (record.label == "crash") CHECK_THAT(read_file(record.folder + "/log.txt"), ContainsSubstring("about to crash"));
  }
  for (const std::string& name : names_in(folder.file("out/tiny"))) CHECK_THAT(name, !ContainsSubstring(".evbench."));

  // Not retried, unless requested.
  const auto before = results_of(folder.file("out/tiny"));
  const SweepProgress again = run(runs, options);
  CHECK(again.before == 7);
  CHECK(reasons(again) == reason);
  CHECK(difference(before, results_of(folder.file("out/tiny"))).empty());
  options.retry_failed = true;
  const std::vector<PlannedRun> exits = {runs[4]};
  CHECK(runs_to_do(exits, known_plugins(), options).size() == 1);
  CHECK(run(exits, options).before == 0);
}

TEST_CASE("A run that is killed from outside is retried once") {
  const TemporaryFolder folder;
  Json config = tiny_config();
  config["backend"] = {{"type", "troublemaker"}, {"what", "die once"}, {"file", folder.file("here")}};
  const SweepProgress progress = run(runs_of(folder, config), {folder.file("out"), 1, {}, false});
  REQUIRE(progress.troubled.size() == 1);
  CHECK(progress.troubled[0].reason == "no estimate is made");  // it was done to the end
}

TEST_CASE("The sweep waits for runs of another process, and takes them over when it ends without a result", "[slow]") {
  const TemporaryFolder folder;
  const std::vector<PlannedRun> runs = runs_of(folder, tiny_config());
  const ExecutorOptions options{folder.file("out"), 1, {}, false};
  auto other = std::make_unique<RunFolder>(options.out, "tiny", runs[0].identity.key);
  bool waited = false;
  const SweepProgress progress = do_runs(runs, known_plugins(), options, [&](const SweepProgress& now) {
    if (now.elsewhere == 0) return;
    waited = true;
    other.reset();
  });
  CHECK(waited);
  CHECK(progress.done == 1);
  CHECK(progress.failed == 0);
}
