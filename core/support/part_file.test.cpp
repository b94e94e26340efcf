#include "core/support/part_file.hpp"

#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>

#include "core/support/error.hpp"
#include "core/testing/data.hpp"

using namespace evbench;
using Catch::Matchers::Contains;

TEST_CASE("A part file has its name, in place of an older file, once it is committed") {
  const bool named = GENERATE(false, true);
  const testing::TemporaryFolder folder;
  const std::string path = folder.write("out", "old");
  PartFile file(path, named);
  std::ofstream(file.writable_path()) << "new";
  CHECK(testing::read_file(path) == "old");
  file.commit();
  CHECK(testing::read_file(path) == "new");
  CHECK(std::distance(std::filesystem::directory_iterator(folder.path()), {}) == 1);
}

TEST_CASE("A part file that is not committed leaves nothing behind") {
  const testing::TemporaryFolder folder;
  {
    const PartFile file(folder.file("out"), GENERATE(false, true));
    std::ofstream(file.writable_path()) << "half";
  }
  CHECK(std::filesystem::is_empty(folder.path()));
}

TEST_CASE("A part file in a folder that is missing, or in the place of a folder, is refused") {
  const testing::TemporaryFolder folder;
  CHECK_THROWS_WITH(PartFile(folder.file("no/out")), Contains("can't be written"));
  CHECK_THROWS_WITH(PartFile(folder.path()), Contains("is a folder"));
}
