#include <sstream>

#include "bench/testing/program.hpp"
#include "core/testing/catch2.hpp"
#include "core/testing/data.hpp"

using namespace evbench;
using namespace evbench::testing;

namespace {

constexpr const char* kTruth =
    "1 0.0 10 10\n1 0.1 11 10\n1 0.2 12 10\n"
    "2 0.0 50 50\n2 0.1 50 51\n2 0.2 50 52\n";
/// The first is exact; the second ends early, 8 px off.
constexpr const char* kTracks = "1 0.0 10 10\n1 0.1 11 10\n1 0.2 12 10\n2 0.0 50 50\n2 0.1 58 51\n";

}  // namespace

TEST_CASE("eval-tracks gives the age of tracks by both protocols") {
  const TemporaryFolder folder;
  folder.write("truth.txt", kTruth);
  folder.write("tracks.txt", kTracks);
  const Outcome outcome = testing::evbench(folder, "eval-tracks truth.txt tracks.txt");
  CAPTURE(outcome.err);
  REQUIRE(outcome.exit_code == 0);
  std::istringstream lines(outcome.out);
  std::string line;
  int found = 0;
  while (std::getline(lines, line)) {
    if (line.rfind("tracks.txt", 0) != 0) continue;
    ++found;
    std::istringstream fields(line);
    std::string file, protocol;
    int tracks = 0;
    double expected = 0.0, inliers = 0.0, age = 0.0;
    fields >> file >> protocol >> tracks >> expected >> inliers >> age;
    CHECK(tracks == 2);
    // The second one's first error, of 8 px, is beyond the thresholds of 1 to 7 px from its beginning on.
    CHECK(inliers > 0.5);
    CHECK(inliers < 1.0);
    CHECK(expected == Approx(inliers * age).margin(0.05));
    if (protocol == "full") CHECK(age < 1.0);
    if (protocol == "cropped") CHECK(age == 1.0);
  }
  CHECK(found == 2);
}

TEST_CASE("eval-tracks refuses what is not there or no track, and says which") {
  const TemporaryFolder folder;
  folder.write("truth.txt", kTruth);
  folder.write("other.txt", "1 2\n");
  const Outcome missing = testing::evbench(folder, "eval-tracks truth.txt nowhere.txt");
  CHECK(missing.exit_code == 2);
  CHECK_THAT(missing.err, Catch::Matchers::ContainsSubstring("nowhere.txt: no such file"));
  const Outcome other = testing::evbench(folder, "eval-tracks truth.txt other.txt");
  CHECK(other.exit_code == 2);
  CHECK_THAT(other.err, Catch::Matchers::ContainsSubstring("other.txt"));
}
