#include "bench/plugins.hpp"

#include "bench/testing/program.hpp"
#include "core/support/json.hpp"
#include "core/testing/catch2.hpp"

using namespace evbench;
using namespace evbench::testing;
using Catch::Matchers::ContainsSubstring;

// core/plugin/library.test.cpp and check_install.cmake test the loading of plugin libraries.

TEST_CASE("Libraries are named by --plugin, an environment variable or a config, and messages say by which", "[slow]") {
  const TemporaryFolder folder;
  folder.write("a.so", "no library");
  Json config = short_config();
  config["plugins"] = {"a.so"};
  folder.write("c.json", dump_json(config));
  const auto refused = [&](const std::string& command, const std::string& place) {
    const Outcome outcome = shell(folder, command);
    INFO(command);
    CHECK(outcome.exit_code == 2);
    CHECK_THAT(outcome.err,
               ContainsSubstring(place + ": ") && ContainsSubstring("a.so: can't be loaded as a shared library"));
  };
  refused("\"$evbench\" --plugin a.so list", "--plugin");
  refused("\"$evbench\" list --plugin a.so", "--plugin");
  refused("\"$evbench\" dataset list --plugin a.so", "--plugin");
  refused("EVBENCH_PLUGINS=:./a.so: \"$evbench\" list", "EVBENCH_PLUGINS");
  refused("\"$evbench\" run c.json", "c.json: plugins");
  CHECK_THAT(shell(folder, "\"$evbench\" list --plugin b.so").err, ContainsSubstring("b.so: no such file"));
  CHECK_THAT(shell(folder, "\"$evbench\" list --plugin").err, ContainsSubstring("--plugin"));
}

TEST_CASE("check-plugin prints a line for each check", "[slow]") {
  const TemporaryFolder folder;
  const Outcome outcome = testing::evbench(folder, "check-plugin oracle --kind frontend");
  CHECK(outcome.exit_code == 0);
  CHECK_THAT(outcome.out,
             ContainsSubstring("frontend oracle (built in):\n  ok    ") && ContainsSubstring("checks hold"));
  CHECK_THAT(outcome.out, !ContainsSubstring("FAILS"));
}

TEST_CASE("A plugin that fails a check ends check-plugin with exit code 3 and says why", "[slow]") {
  const TemporaryFolder folder;
  const Outcome outcome =
      testing::evbench(folder, "check-plugin bundle_adjustment --options '{\"batch_duration\": 3}'");
  CHECK(outcome.exit_code == 3);
  CHECK_THAT(outcome.out, ContainsSubstring("  FAILS follows a good sequence in time order and shows a map: "));
}

TEST_CASE("A plugin that can't be checked is an error with a message", "[slow]") {
  const TemporaryFolder folder;
  const auto refused = [&](const std::string& arguments, const std::string& message) {
    const Outcome outcome = testing::evbench(folder, "check-plugin " + arguments);
    INFO(arguments);
    CHECK(outcome.exit_code == 2);
    CHECK_THAT(outcome.err, ContainsSubstring(message));
  };
  refused("gp_mop", "no plugin is called \"gp_mop\"; did you mean \"gp_map\"?");
  refused("oracle --kind backend", "no plugin is called \"oracle\"");
  refused("recorded", "\"tracks\" is missing");
  refused("oracle --options '{'", "--options: { is not JSON");
  refused("oracle --source '{}'", "--source: expected an object with \"type\"");
  refused("oracle --source '{\"type\": \"simulatoin\"}'", "did you mean \"simulation\"?");
}
