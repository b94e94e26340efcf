#include "bench/testing/program.hpp"
#include "core/support/json.hpp"
#include "core/testing/catch2.hpp"

using namespace evbench;
using namespace evbench::testing;
using Catch::Matchers::ContainsSubstring;

namespace {

/// 0.4 s of a text without a header, over 346x260 pixels.
void write_text_events(const TemporaryFolder& folder, const std::string& name) {
  std::string text;
  for (int i = 0; i < 2000; ++i) {
    text += fmt::format("{:.6f} {} {} {}\n", 5.0 + 2e-4 * i, i * 7 % 346, i * 11 % 260, i % 2);
  }
  folder.write(name, text);
}

Json config_of(const TemporaryFolder& folder, const std::string& name) {
  return Json::parse(read_file(folder.file(name)), nullptr, true, true);
}

}  // namespace

TEST_CASE("new-config writes a config for a recording that runs unchanged", "[slow]") {
  const TemporaryFolder folder;
  write_text_events(folder, "mine.txt");
  folder.write("cam.txt", "250 250 173 130 0 0 0 0 0\n");
  const Outcome made = testing::evbench(folder, "new-config mine.txt --calibration cam.txt");
  CAPTURE(made.err);
  REQUIRE(made.exit_code == 0);
  CHECK(made.out == "written: mine.json\nevbench run mine.json\n");
  const Json source = config_of(folder, "mine.json")["source"];
  CHECK(source["events"] == "mine.txt");
  CHECK(source["calibration"] == "cam.txt");
  CHECK(source["width"] == 346);
  CHECK(source["height"] == 260);
  CHECK(source["time_range"][0].get<double>() == Approx(5.0));
  CHECK(source["time_range"][1].get<double>() == Approx(5.3998));
  CHECK(testing::evbench(folder, "run mine.json --check").exit_code == 0);
  const Outcome run = testing::evbench(folder, "run mine.json");
  CHECK(run.exit_code == 3);  // noise gives no map
  CHECK_THAT(run.out, ContainsSubstring("gp_map") && ContainsSubstring("bundle_adjustment"));
}

TEST_CASE("new-config takes files in the recording's folder, and the time that events and ground truth share",
          "[slow]") {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder.file("mine"));
  write_text_events(folder, "mine/events.txt");
  folder.write("mine/calib.txt", "250 250 173 130 0 0 0 0 0\n");
  folder.write("mine/groundtruth.txt", "5.1 0 0 0 0 0 0 1\n5.2 0.1 0 0 0 0 0 1\n9 1 0 0 0 0 0 1\n");
  REQUIRE(testing::evbench(folder, "new-config mine/ --out a.json --width 346 --height 260").exit_code == 0);
  const Json source = config_of(folder, "a.json")["source"];
  CHECK(source["folder"] == "mine");
  CHECK(source["width"] == 346);
  CHECK_FALSE(source.contains("calibration"));
  CHECK(source["time_range"][0].get<double>() == Approx(5.1));
  CHECK(source["time_range"][1].get<double>() == Approx(5.3998));
  CHECK(testing::evbench(folder, "run a.json --check").exit_code == 0);
}

TEST_CASE("new-config reports what is missing, and replaces nothing without a request", "[slow]") {
  const TemporaryFolder folder;
  write_text_events(folder, "mine.txt");
  const Outcome none = testing::evbench(folder, "new-config mine.txt");
  CHECK(none.exit_code == 2);
  CHECK_THAT(none.err, ContainsSubstring("no calibration was found") && ContainsSubstring("--calibration FILE"));
  CHECK(names_in(folder.path()) == std::set<std::string>{"mine.txt"});
  folder.write("cam.txt", "250 250 173 130 0 0 0 0 0\n");
  folder.write("mine.json", "{}");
  CHECK(testing::evbench(folder, "new-config mine.txt --calibration cam.txt").exit_code == 2);
  CHECK(read_file(folder.file("mine.json")) == "{}");
  CHECK(testing::evbench(folder, "new-config mine.txt --calibration cam.txt --force").exit_code == 0);
}

TEST_CASE("A recording instead of a config is refused, with the command that makes one", "[slow]") {
  const TemporaryFolder folder;
  write_text_events(folder, "mine.txt");
  const Outcome run = testing::evbench(folder, "run mine.txt");
  CHECK(run.exit_code == 2);
  CHECK_THAT(run.err, ContainsSubstring("mine.txt: is a recording of events, no config") &&
                          ContainsSubstring("evbench new-config mine.txt"));
}
