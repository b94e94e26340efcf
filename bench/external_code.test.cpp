#include "bench/testing/program.hpp"
#include "core/support/json.hpp"
#include "core/testing/catch2.hpp"

using namespace evbench;
using namespace evbench::testing;
using Catch::Matchers::ContainsSubstring;

// Code that a config from others may make the program run: commands of the plugins "process", libraries in the key
// "plugins". A command that was started leaves a file.

namespace {

Json config_with_command() {
  Json config = short_config();
  config["backend"] = {{"type", "process"}, {"command", "touch started; exit 1"}};
  return config;
}

Json config_with_library() {
  Json config = short_config();
  config["plugins"] = {"a.so"};
  config["backend"] = {{"type", "mine"}};
  return config;
}

}  // namespace

TEST_CASE("Checking a config starts no command that it names", "[slow]") {
  const TemporaryFolder folder;
  folder.write("c.json", dump_json(config_with_command()));
  const auto fine = [&](const std::string& command) {
    CAPTURE(command);
    const Outcome outcome = testing::evbench(folder, command);
    CAPTURE(outcome.err);
    CHECK(outcome.exit_code == 0);
    CHECK_FALSE(names_in(folder.path()).contains("started"));
    return outcome.out;
  };
  CHECK_THAT(fine("run c.json --check"),
             ContainsSubstring("fine, 1 run") &&
                 ContainsSubstring("not checked: c.json: backend: \"touch started; exit 1\" was not started"));
  fine("sweep c.json --dry-run");
  fine("export c.json --tracks tracks.txt");
  CHECK(testing::evbench(folder, "run c.json --check --set backend.command=[]").exit_code == 2);
}

TEST_CASE("run and sweep print the commands that they start, and refuse them with --no-external", "[slow]") {
  const TemporaryFolder folder;
  folder.write("c.json", dump_json(config_with_command()));
  const std::string runs = GENERATE("run c.json", "sweep c.json -j 1");
  for (const char* refused : {"\"$evbench\" --no-external ", "EVBENCH_NO_EXTERNAL=1 \"$evbench\" "}) {
    const Outcome outcome = testing::shell(folder, refused + runs);
    CHECK(outcome.exit_code == 2);
    CHECK_THAT(outcome.err, ContainsSubstring("would run \"touch started; exit 1\"") &&
                                ContainsSubstring("external code is refused"));
    CHECK_FALSE(names_in(folder.path()).contains("started"));
  }
  const Outcome outcome = testing::evbench(folder, runs);
  CHECK_THAT(outcome.out, Catch::Matchers::StartsWith("runs, as the config says: touch started; exit 1\n"));
  CHECK(outcome.exit_code == 3);
  CHECK(names_in(folder.path()).contains("started"));
}

TEST_CASE("Commands that only check a config do not load its libraries, and list what is not checked", "[slow]") {
  const TemporaryFolder folder;
  folder.write("a.so", "no library");  // loading it would be an error
  folder.write("c.json", dump_json(config_with_library()));
  const Outcome check = testing::evbench(folder, "run c.json --check");
  CHECK(check.exit_code == 0);
  CHECK_THAT(check.out, ContainsSubstring("its source is fine; not checked: backend mine") &&
                            ContainsSubstring("a.so is not loaded") && ContainsSubstring("--plugin"));
  const Outcome plan = testing::evbench(folder, "sweep c.json --dry-run");
  CHECK(plan.exit_code == 2);
  CHECK_THAT(plan.err, ContainsSubstring("a.so, which --dry-run does not load; --plugin"));
  CHECK(testing::evbench(folder, "export c.json --tracks tracks.txt").exit_code == 0);
  const Outcome other = testing::evbench(folder, "export c.json --tracks t.txt --set source.type=mine");
  CHECK_THAT(other.err, ContainsSubstring("no source is called \"mine\"") && ContainsSubstring("a.so is not loaded"));
  const Outcome refused = testing::evbench(folder, "--no-external run c.json");
  CHECK(refused.exit_code == 2);
  CHECK_THAT(refused.err, ContainsSubstring("a.so, which --no-external does not load"));
  const Outcome run = testing::evbench(folder, "run c.json");
  CHECK_THAT(run.out, Catch::Matchers::StartsWith("loads, as c.json: plugins says: ") && ContainsSubstring("a.so"));
  CHECK_THAT(run.err, ContainsSubstring("can't be loaded as a shared library"));
}
