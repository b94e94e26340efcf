#include "bench/new_plugin/new_plugin.hpp"

#include <algorithm>
#include <filesystem>

#include "bench/commands/exit_code.hpp"
#include "bench/testing/program.hpp"
#include "core/support/error.hpp"
#include "core/support/json.hpp"
#include "core/testing/catch2.hpp"

using namespace evbench;
using namespace evbench::testing;
using Catch::Matchers::ContainsSubstring;

// check_install.cmake tests that the written plugin builds, passes its tests and gives a table.

TEST_CASE("A new plugin has a source, a test, a config and a README with its name in place of the templates'") {
  const TemporaryFolder folder;
  const std::string kind = GENERATE("backend", "frontend", "source");
  const std::string path = folder.file("deep/my_2nd_try");
  write_new_plugin(kind, "my_2nd_try", path);
  CHECK(names_in(path) == std::set<std::string>{".gitignore", "CMakeLists.txt", "README.md", "config.json",
                                                "my_2nd_try.cpp", "my_2nd_try.test.cpp"});
  CHECK(names_in(folder.file("deep")) == std::set<std::string>{"my_2nd_try"});
  for (const std::string& name : names_in(path)) {
    const std::string text = read_file(path + "/" + name);
    INFO(name);
    CHECK_THAT(text, !ContainsSubstring("NAME") && !ContainsSubstring("ClassName"));
  }
  CHECK_THAT(read_file(path + "/my_2nd_try.cpp"),
             ContainsSubstring("class My2ndTry : ") && ContainsSubstring("registration(\"my_2nd_try\""));
  CHECK_THAT(read_file(path + "/README.md"),
             ContainsSubstring("evbench --plugin build/libmy_2nd_try.so run config.json"));
  CHECK(parse_json(read_file(path + "/config.json")).at("name") == "my_2nd_try");
}

TEST_CASE("The program prints how to build a new plugin, whose folder may exist if it is empty") {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder.file("empty"));
  const Outcome outcome = testing::evbench(folder, "new-plugin backend mine --out empty/");
  CHECK(outcome.exit_code == 0);
  CHECK_THAT(outcome.out, ContainsSubstring("cd empty/\n") &&
                              ContainsSubstring("evbench --plugin build/libmine.so run config.json"));
  CHECK(names_in(folder.file("empty")).contains("mine.cpp"));
  CHECK(testing::evbench(folder, "new-plugin source mine").exit_code == 0);
  CHECK(names_in(folder.path()) == std::set<std::string>{"empty", "mine"});
  CHECK(testing::evbench(folder, "new-plugin backend small_one --minimal").exit_code == 0);
  CHECK(names_in(folder.file("small_one")) ==
        std::set<std::string>{".gitignore", "CMakeLists.txt", "config.json", "small_one.cpp"});
  const std::string source = read_file(folder.file("small_one/small_one.cpp"));
  CHECK_THAT(source, ContainsSubstring("class SmallOne : ") && !ContainsSubstring("NAME"));
  CHECK(std::ranges::count(source, '\n') < 60);
}

TEST_CASE("A new plugin with bad arguments is an error with a message, and no file is left behind", "[slow]") {
  const TemporaryFolder folder;
  folder.write("file", "");
  std::filesystem::create_directory(folder.file("full"));
  folder.write("full/thing", "");
  const auto refused = [&](const std::string& arguments, const std::string& message, int exit_code = kExitBadInput) {
    const Outcome outcome = testing::evbench(folder, "new-plugin " + arguments);
    INFO(arguments);
    CHECK(outcome.exit_code == exit_code);
    CHECK_THAT(outcome.err, ContainsSubstring(message));
    CHECK(names_in(folder.path()) == std::set<std::string>{"file", "full"});
  };
  refused("backend Mine", "\"Mine\" can't name a plugin; expected a lower-case letter");
  refused("backend 2nd", "can't name a plugin");
  refused("backend my-plugin", "can't name a plugin");
  refused("backend ''", "can't name a plugin");
  refused("backend test", "CMake reserves");
  refused("backend gp_map", "there is a backend \"gp_map\" already (built in)");
  refused("tracker mine", "tracker");
  refused("bakend mine", "did you mean \"backend\"?");
  refused("source mine --minimal", "--minimal: is for a backend; this is a source");
  refused("backend mine --out full", "full: is there already; expected a new folder");
  refused("backend mine --out file", "file: is there already");
  refused("backend mine --out file/mine", "file", kExitNotWritten);
  refused("backend mine --out /proc/mine", "/proc/mine", kExitNotWritten);
}
