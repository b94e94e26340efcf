#include "core/io/part_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "core/support/error.hpp"
#include "core/testing/catch2.hpp"
#include "core/testing/data.hpp"

using namespace evbench;
using Catch::Matchers::ContainsSubstring;

TEST_CASE("A committed part file has its name and replaces an older file") {
  const PartFile::Needs needs = GENERATE(PartFile::Needs::nothing, PartFile::Needs::seeking, PartFile::Needs::name);
  const testing::TemporaryFolder folder;
  const std::string path = folder.write("out", "old");
  PartFile file(path, needs);
  std::ofstream(file.writable_path()) << "new";
  CHECK(testing::read_file(path) == "old");
  file.commit();
  CHECK(testing::read_file(path) == "new");
  CHECK(std::distance(std::filesystem::directory_iterator(folder.path()), {}) == 1);
}

TEST_CASE("A part file that is not committed leaves nothing behind") {
  const testing::TemporaryFolder folder;
  {
    const PartFile file(folder.file("out"), GENERATE(PartFile::Needs::seeking, PartFile::Needs::name));
    std::ofstream(file.writable_path()) << "half";
  }
  CHECK(std::filesystem::is_empty(folder.path()));
}

TEST_CASE("A part file in a missing folder, or with the name of a folder, is refused") {
  const testing::TemporaryFolder folder;
  CHECK_THROWS_WITH(PartFile(folder.file("no/out")), ContainsSubstring("can't be written"));
  CHECK_THROWS_WITH(PartFile(folder.path()), ContainsSubstring("is a folder"));
}

TEST_CASE("Part files do not use existing names, nor each other's") {
  const PartFile::Needs needs = GENERATE(PartFile::Needs::seeking, PartFile::Needs::name);
  const testing::TemporaryFolder folder;
  const std::string path = folder.file("out");
  const std::string usual = "out.part" + std::to_string(::getpid());
  folder.write(usual, "mine");
  std::filesystem::create_symlink("elsewhere", folder.file(usual + "-1"));
  folder.write("out.part", "mine, too");
  PartFile first(path, needs), second(path, needs);
  std::ofstream(first.writable_path()) << "first";
  std::ofstream(second.writable_path()) << "second";
  second.commit();
  CHECK(testing::read_file(path) == "second");
  first.commit();
  CHECK(testing::read_file(path) == "first");
  CHECK(testing::read_file(folder.file(usual)) == "mine");
  CHECK(testing::read_file(folder.file("out.part")) == "mine, too");
  CHECK(std::distance(std::filesystem::directory_iterator(folder.path()), {}) == 4);
}

TEST_CASE("A part file replaces the target of a link and keeps its permissions") {
  const PartFile::Needs needs = GENERATE(PartFile::Needs::seeking, PartFile::Needs::name);
  const testing::TemporaryFolder folder;
  std::filesystem::create_directory(folder.file("disk"));
  std::filesystem::create_symlink("disk/target", folder.file("link"));
  for (const char* content : {"new", "newer"}) {  // the link's target does not exist, then it does
    PartFile file(folder.file("link"), needs);
    std::ofstream(file.writable_path()) << content;
    file.commit();
    CHECK(std::filesystem::is_symlink(folder.file("link")));
    CHECK(testing::read_file(folder.file("disk/target")) == content);
    const auto owner_only = std::filesystem::perms::owner_read | std::filesystem::perms::owner_write;
    if (std::string(content) == "new") std::filesystem::permissions(folder.file("disk/target"), owner_only);
    if (std::string(content) == "newer") {
      CHECK(std::filesystem::status(folder.file("disk/target")).permissions() == owner_only);
    }
  }
}

TEST_CASE("A pipe is written to if that suffices and refused otherwise, and it stays a pipe") {
  const testing::TemporaryFolder folder;
  const std::string pipe = folder.file("pipe");
  REQUIRE(::mkfifo(pipe.c_str(), 0600) == 0);
  const int reader = ::open(pipe.c_str(), O_RDONLY | O_NONBLOCK);
  {
    PartFile file(pipe, PartFile::Needs::nothing);
    std::ofstream(file.writable_path()) << "text";
    file.commit();
  }
  char text[10] = {};
  CHECK(::read(reader, text, sizeof text) == 4);
  CHECK(std::string(text) == "text");
  ::close(reader);
  CHECK_THROWS_WITH(PartFile(pipe, PartFile::Needs::seeking),
                    ContainsSubstring("is a pipe or a device; expected a file"));
  CHECK_THROWS_AS(PartFile("/dev/null", PartFile::Needs::name), InputError);
  CHECK(std::filesystem::is_fifo(pipe));
}
