#include "core/data/map_file.hpp"

#include "core/io/atomic_file.hpp"
#include "core/testing/catch2.hpp"
#include "core/testing/data.hpp"

using namespace evbench;
using namespace evbench::testing;

TEST_CASE("A map is read back as written") {
  const TemporaryFolder folder;
  const std::vector<Landmark> map = {{17, {0.5, -1.25, 3.0}}, {1234567890123, {1e-3, 2.0, 1e6}}};
  write_file(folder.file("map.ply"), format_map(map));
  const std::vector<Landmark> read = read_map(folder.file("map.ply"));
  REQUIRE(read.size() == 2);
  CHECK(read[1].track == 1234567890123);
  CHECK(read[0].position == map[0].position);
  CHECK(read[1].position == map[1].position);
}

TEST_CASE("A file that is no map is refused with its place") {
  const TemporaryFolder folder;
  write_file(folder.file("a.ply"), "solid\n1 2 3\n");
  CHECK_THROWS_WITH(read_map(folder.file("a.ply")), Catch::Matchers::ContainsSubstring("a.ply:1"));
  write_file(folder.file("b.ply"), "ply\nformat ascii 1.0\n");
  CHECK_THROWS_WITH(read_map(folder.file("b.ply")), Catch::Matchers::ContainsSubstring("end_header"));
  write_file(folder.file("c.ply"), "ply\nend_header\n1 2 x 4\n");
  CHECK_THROWS_WITH(read_map(folder.file("c.ply")), Catch::Matchers::ContainsSubstring("c.ply:3"));
}
