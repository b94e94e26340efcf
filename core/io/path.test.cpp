#include "core/io/path.hpp"

#include <cstdlib>
#include <filesystem>

#include "core/support/error.hpp"
#include "core/testing/catch2.hpp"
#include "core/testing/data.hpp"

using namespace evbench;
using Catch::Matchers::ContainsSubstring;

TEST_CASE("Relative paths are relative to the folder, absolute ones are unchanged") {
  CHECK(resolve_path("a/b.txt", "/folder") == "/folder/a/b.txt");
  CHECK(resolve_path("../b.txt", "/folder/c") == "/folder/b.txt");
  CHECK(resolve_path("/a/b.txt", "/folder") == "/a/b.txt");
  CHECK(resolve_path("a", "") == "a");
}

TEST_CASE("Environment variables in paths are replaced, and unset ones are refused with what to set") {
  REQUIRE(::setenv("EVBENCH_TEST_VARIABLE", "/data", 1) == 0);
  CHECK(resolve_path("${EVBENCH_TEST_VARIABLE}/x", "/folder") == "/data/x");
  CHECK(resolve_path("/a/${EVBENCH_TEST_VARIABLE}/${EVBENCH_TEST_VARIABLE}", "") == "/a//data//data");
  REQUIRE(::unsetenv("EVBENCH_TEST_VARIABLE") == 0);
  CHECK_THROWS_AS(resolve_path("${EVBENCH_TEST_VARIABLE}/x", ""), InputError);
  CHECK_THROWS_WITH(resolve_path("${EVBENCH_TEST_VARIABLE}/x", ""),
                    ContainsSubstring("EVBENCH_TEST_VARIABLE is not set"));
  CHECK_THROWS_WITH(resolve_path("${EVBENCH_TEST_VARIABLE", ""), ContainsSubstring("closing brace"));
}

TEST_CASE("Links are followed to their target, even to a missing one, but not in a circle") {
  const testing::TemporaryFolder folder;
  const auto link = [&](const char* target, const char* name) {
    std::filesystem::create_symlink(target, folder.file(name));
    return folder.file(name);
  };
  std::filesystem::create_directory(folder.file("sub"));
  CHECK(follow_links(link("sub/b", "a")) == folder.file("sub/b"));
  link("/nowhere/x", "sub/b");
  CHECK(follow_links(folder.file("a")) == "/nowhere/x");
  CHECK(follow_links(folder.file("none")) == folder.file("none"));
  link("two", "one");
  CHECK_THROWS_WITH(follow_links(link("one", "two")), ContainsSubstring("in a circle"));
}

TEST_CASE("An anchored path is the same for every folder and keeps its variables") {
  CHECK(anchored_path("a/b.txt", "/folder") == "/folder/a/b.txt");
  CHECK(anchored_path("/a", "/folder") == "/a");
  CHECK(anchored_path("${EVBENCH_DATA}/a", "/folder") == "${EVBENCH_DATA}/a");
}
