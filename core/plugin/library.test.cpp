#include "core/plugin/library.hpp"

#include <filesystem>

#include "core/plugin/abi.hpp"
#include "core/plugin/registration.hpp"
#include "core/support/error.hpp"
#include "core/support/json.hpp"
#include "core/testing/catch2.hpp"
#include "core/testing/data.hpp"

using namespace evbench;
using Catch::Matchers::ContainsSubstring;
using Catch::Matchers::StartsWith;

namespace {

/// A plugin of the test program itself.
class Own : public BackEnd {
 public:
  struct Options {
    void declare(OptionSet&) {}
  };
  Own(const Options&, const BackEndContext&) {}
  void advance(const UndistortedBatch&) override {}
  BackEndFeedback feedback(const FeedbackNeeds&) override { return {}; }
  void finish() override {}
  Status status() const override { return {}; }
  PoseTrajectory trajectory() const override { return {}; }
  std::vector<Landmark> map() const override { return {}; }
};

const Registration<BackEnd, Own> registration("own", "of the test program");

std::string library(const std::string& name) { return std::string(EVBENCH_TEST_LIBRARIES "/lib") + name + ".so"; }

std::vector<std::string> names(const Plugins& plugins) {
  std::vector<std::string> result;
  for (const auto& [name, entry] : plugins.of<BackEnd>().entries()) result.push_back(name);
  return result;
}

/// The message with which a path is refused; checks that nothing was added.
std::string refusal(const std::string& path, Plugins plugins = registered_plugins()) {
  const std::vector<std::string> before = names(plugins);
  std::string message;
  try {
    load_plugin_libraries(plugins, path);
  } catch (const InputError& error) {
    message = error.what();
  }
  CHECK(names(plugins) == before);
  return message;
}

}  // namespace

TEST_CASE("A library adds its plugins to the program's, and does not register the program's own again") {
  Plugins plugins = registered_plugins();
  REQUIRE(names(plugins) == std::vector<std::string>{"own"});
  load_plugin_libraries(plugins, library("tiny"));
  CHECK(names(plugins) == std::vector<std::string>{"own", "tiny"});
  CHECK(names(registered_plugins()) == std::vector<std::string>{"own"});

  const auto& entry = plugins.of<BackEnd>().find("tiny", "test");
  CHECK(entry.origin == std::filesystem::canonical(library("tiny")).string());
  CHECK(plugins.of<BackEnd>().find("own", "test").origin == "built in");
  const Json options = entry.resolve(Json{{"count", 7}}, "test", "");
  CHECK(entry.make(options, {})->status().reason == "7");
}

TEST_CASE("An error of a library's plugin reaches the program with its type") {
  Plugins plugins;
  load_plugin_libraries(plugins, library("tiny"));
  const auto& entry = plugins.of<BackEnd>().find("tiny", "test");
  CHECK_THROWS_AS(entry.make(Json{{"count", 0}}, {}), InputError);
  CHECK_THROWS_AS(entry.resolve(Json{{"cuont", 1}}, "test", ""), InputError);
}

TEST_CASE("A library that is named twice, even by different paths, is loaded once") {
  const testing::TemporaryFolder folder;
  std::filesystem::create_symlink(library("tiny"), folder.file("link.so"));
  Plugins plugins;
  load_plugin_libraries(plugins, library("tiny"));
  load_plugin_libraries(plugins, folder.path());
  CHECK(names(plugins) == std::vector<std::string>{"tiny"});
}

TEST_CASE("All libraries of a folder are loaded, in the order of their names") {
  const testing::TemporaryFolder folder;
  folder.write("notes.txt", "no library");
  std::filesystem::copy_file(library("tiny"), folder.file("libb.so"));
  std::filesystem::copy_file(library("no_plugin"), folder.file("liba.so"));
  CHECK_THAT(refusal(folder.path()), ContainsSubstring("liba.so: is no plugin"));
  std::filesystem::rename(folder.file("liba.so"), folder.file("liba.so.old"));
  Plugins plugins;
  load_plugin_libraries(plugins, folder.path());
  CHECK(names(plugins) == std::vector<std::string>{"tiny"});
}

TEST_CASE("A file that is no library or does not exist is refused with a sentence") {
  const testing::TemporaryFolder folder;
  CHECK_THAT(refusal(folder.file("none.so")), StartsWith(folder.file("none.so") + ": no such file"));
  CHECK_THAT(refusal(folder.path()), ContainsSubstring("has no shared library"));
  folder.write("text.so", "not a library");
  CHECK_THAT(refusal(folder.file("text.so")), ContainsSubstring("can't be loaded as a shared library: "));
  CHECK_THAT(refusal(folder.path()), ContainsSubstring("text.so"));
  folder.write("empty.so", "");
  CHECK_THAT(refusal(folder.file("empty.so")), ContainsSubstring("can't be loaded as a shared library: "));
}

TEST_CASE("A library that is no plugin or lacks a symbol is refused with a sentence") {
  CHECK_THAT(refusal(library("no_plugin")),
             ContainsSubstring("is no plugin of evbench") && ContainsSubstring("evbench_plugin_abi"));
  CHECK_THAT(refusal(library("missing_symbol")),
             ContainsSubstring("undefined symbol") && ContainsSubstring("nobody_has_this"));
  CHECK_THAT(refusal(library("registers_nothing")), ContainsSubstring("registers no plugin"));
  CHECK_THAT(refusal(library("throws")), ContainsSubstring("registration failed: the licence server is down"));
}

TEST_CASE("A library of another ABI is refused before any of its code runs, with both ABI texts and their difference") {
  const std::string message = refusal(library("other_abi"));
  CHECK_THAT(message, ContainsSubstring("api 99 instead of api " EVBENCH_ABI_TEXT(EVBENCH_PLUGIN_API)));
  CHECK_THAT(message, ContainsSubstring("api 99; gcc 3; no sanitizer") && ContainsSubstring(plugin_abi()));
}

TEST_CASE("A name that is taken is refused with both origins, and nothing of the library is added") {
  Plugins plugins;
  load_plugin_libraries(plugins, library("tiny"));
  const std::string message = refusal(library("twin"), plugins);
  CHECK_THAT(message, ContainsSubstring("two backends are called \"tiny\"") && ContainsSubstring("libtiny.so") &&
                          ContainsSubstring("libtwin.so"));
}
