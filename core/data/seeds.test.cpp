#include "core/data/seeds.hpp"

#include <cmath>

#include "core/support/error.hpp"
#include "core/testing/catch2.hpp"
#include "core/testing/data.hpp"

using namespace evbench;

TEST_CASE("Seeds are the first observations of tracks, in time order") {
  const testing::TemporaryFolder folder;
  folder.write("seeds.txt", "7 0.2 1 2\n3 0.1 3 4\n7 0.3 5 6\n");
  Seeds seeds("seeds.txt", folder.path());
  CHECK(seeds.given());
  CHECK(seeds.next_id() == 8);
  CHECK(seeds.next() == 0.1);
  CHECK(seeds.take(0.15).size() == 1);
  const auto rest = seeds.take(1.0);
  REQUIRE(rest.size() == 1);
  CHECK(rest[0].pixel == Vector2(1, 2));
  CHECK(std::isinf(seeds.next()));
}

TEST_CASE("Without a file there are no seeds, and an id that leaves none above it is refused") {
  const testing::TemporaryFolder folder;
  CHECK_FALSE(Seeds("", folder.path()).given());
  folder.write("seeds.txt", "9223372036854775807 0.1 3 4\n");
  CHECK_THROWS_WITH(Seeds("seeds.txt", folder.path()),
                    Catch::Matchers::ContainsSubstring("seeds.txt: the id 9223372036854775807"));
}
