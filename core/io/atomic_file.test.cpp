#include "core/io/atomic_file.hpp"

#include <filesystem>

#include "core/support/error.hpp"
#include "core/testing/catch2.hpp"
#include "core/testing/data.hpp"

using namespace evbench;
using Catch::Matchers::ContainsSubstring;
using testing::read_file;

namespace {

std::size_t count_entries(const std::string& folder) {
  return static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator(folder), {}));
}

}  // namespace

TEST_CASE("A file is written completely, replaces an older one, and leaves nothing else behind") {
  const testing::TemporaryFolder folder;
  write_file(folder.file("a"), "first");
  write_file(folder.file("a"), "second");
  CHECK(read_file(folder.file("a")) == "second");
  CHECK(count_entries(folder.path()) == 1);
}

TEST_CASE("A file that can't be written is an error that names it, and leaves nothing behind") {
  const testing::TemporaryFolder folder;
  CHECK_THROWS_WITH(write_file(folder.file("no/a"), "x"),
                    ContainsSubstring("no/a: can't be written") && !ContainsSubstring(".part"));
  CHECK_THROWS_WITH(write_file(folder.path(), "x"), ContainsSubstring("is a folder"));
  CHECK_THROWS_WITH(write_file("/dev/full", "x"), ContainsSubstring("/dev/full: can't be written: No space"));
  CHECK(count_entries(folder.path()) == 0);
}

TEST_CASE("An existing file is replaced only on request, and a file that is read never") {
  const testing::TemporaryFolder folder;
  const std::string path = folder.write("a", "mine");
  std::filesystem::create_symlink("a", folder.file("link"));
  CHECK_THROWS_WITH(check_outputs({path}, {}, false), ContainsSubstring("a: exists already; --force replaces it"));
  CHECK_THROWS_AS(check_outputs({folder.file("link")}, {}, false), InputError);
  CHECK_THROWS_AS(check_outputs({folder.path()}, {}, false), InputError);
  CHECK_NOTHROW(check_outputs({path, ""}, {}, true));
  CHECK_NOTHROW(check_outputs({folder.file("b")}, {path}, false));
  CHECK_NOTHROW(check_outputs({"/dev/stdout", "/dev/stdout"}, {}, false));
  CHECK_THROWS_WITH(check_outputs({folder.file("link")}, {path}, true), ContainsSubstring("link: is also an input"));
  CHECK_THROWS_WITH(check_outputs({folder.file("b"), folder.file("./b")}, {}, true),
                    ContainsSubstring("is given as two outputs"));
  CHECK_THROWS_WITH(check_outputs({"-"}, {}, true), ContainsSubstring("/dev/stdout"));
  CHECK(read_file(path) == "mine");
}

TEST_CASE("A folder appears complete when it is committed, and replaces an older one") {
  const testing::TemporaryFolder folder;
  const std::string path = folder.file("x/run");
  for (const char* content : {"first", "second"}) {
    AtomicFolder run(path);
    run.write("a", content);
    CHECK((!std::filesystem::exists(path) || read_file(path + "/a") == "first"));
    run.commit();
    CHECK(read_file(path + "/a") == content);
  }
  CHECK(count_entries(folder.file("x")) == 1);
}

TEST_CASE("A folder that is not committed leaves what was there before") {
  const testing::TemporaryFolder folder;
  const std::string path = folder.file("run");
  {
    AtomicFolder run(path);
    run.write("a", "old");
    run.commit();
  }
  {
    const AtomicFolder run(path);
    run.write("a", "new");
    CHECK_THROWS_WITH(run.write("no/b", "x"),
                      ContainsSubstring("run/no/b: can't be written") && !ContainsSubstring(".part"));
  }
  CHECK(read_file(path + "/a") == "old");
  CHECK(count_entries(folder.path()) == 1);
}

TEST_CASE("A folder replaces the target of a link and leaves other files next to it unchanged") {
  const testing::TemporaryFolder folder;
  std::filesystem::create_directories(folder.file("disk/run"));
  std::filesystem::create_symlink("disk/run", folder.file("run"));
  std::filesystem::create_directory(folder.file("disk/run.part"));
  folder.write("disk/run.part/a", "mine");
  {
    AtomicFolder run(folder.file("run"));
    run.write("a", "new");
    run.commit();
  }
  CHECK(std::filesystem::is_symlink(folder.file("run")));
  CHECK(read_file(folder.file("disk/run/a")) == "new");
  CHECK(read_file(folder.file("disk/run.part/a")) == "mine");
  CHECK(count_entries(folder.file("disk")) == 2);
}

TEST_CASE("A cleared folder contains only what is written afterwards") {
  const testing::TemporaryFolder folder;
  AtomicFolder run(folder.file("run"));
  run.write("a", "half");
  run.clear();
  run.write("b", "whole");
  run.commit();
  CHECK(count_entries(folder.file("run")) == 1);
  CHECK(read_file(folder.file("run/b")) == "whole");
}

TEST_CASE("A folder has one writer at a time") {
  const testing::TemporaryFolder folder;
  {
    const AtomicFolder first(folder.file("run"));
    CHECK_THROWS_AS(AtomicFolder(folder.file("run")), FolderTaken);
    CHECK_NOTHROW(AtomicFolder(folder.file("other")));
    CHECK(AtomicFolder::is_taken(folder.file("run")));
    CHECK_FALSE(AtomicFolder::is_taken(folder.file("other")));
  }
  CHECK_FALSE(AtomicFolder::is_taken(folder.file("run")));
  CHECK_NOTHROW(AtomicFolder(folder.file("run")));
}

TEST_CASE("Leftovers of a killed writer are removed, and the folder that it was replacing is restored") {
  const testing::TemporaryFolder folder;
  std::filesystem::create_directory(folder.file("run.evbench.part"));
  folder.write("run.evbench.part/half", "x");
  std::filesystem::create_directory(folder.file("run.evbench.old"));
  folder.write("run.evbench.old/a", "old");
  folder.write("run.evbench.lock", "");
  AtomicFolder::clear_leftovers(folder.file("run"));
  CHECK(read_file(folder.file("run/a")) == "old");
  CHECK(count_entries(folder.path()) == 1);
  std::filesystem::create_directory(folder.file("run.evbench.old"));  // it was replaced, but not yet removed
  folder.write("run.evbench.old/a", "older");
  folder.write("run.evbench.lock", "");
  {
    const AtomicFolder run(folder.file("run"));
    AtomicFolder::clear_leftovers(folder.file("run"));
    CHECK(AtomicFolder::is_taken(folder.file("run")));
  }
  CHECK(read_file(folder.file("run/a")) == "old");
  CHECK(count_entries(folder.path()) == 1);
}
