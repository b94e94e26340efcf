#include <opencv2/imgcodecs.hpp>

#include "bench/render/testing/recording.hpp"
#include "bench/testing/program.hpp"
#include "core/support/json.hpp"
#include "core/testing/catch2.hpp"

using namespace evbench;
using namespace evbench::testing;
using Catch::Matchers::ContainsSubstring;

namespace {

/// "a.evb": 50 ms, one event per millisecond.
void write_recording_of_events(const TemporaryFolder& folder) {
  std::vector<Event> events;
  for (int i = 0; i < 50; ++i) events.push_back({1000 * i, static_cast<std::uint16_t>(i % 20), 3, i % 2 == 0});
  write_native(folder, "a.evb", events);
}

}  // namespace

TEST_CASE("render writes a picture, a folder of pictures, or a video, and says so", "[slow]") {
  const TemporaryFolder folder;
  write_recording_of_events(folder);
  Outcome outcome = testing::evbench(folder, "render a.evb a.png --from 0.01 --to 0.03 --scale 4 --dark");
  CHECK(outcome.exit_code == 0);
  CHECK(outcome.err.empty());
  CHECK(outcome.out == "written: a.png, 1 picture of 80x40 pixels\n");
  CHECK(cv::imread(folder.file("a.png")).size() == cv::Size(80, 40));

  outcome = testing::evbench(folder, "render a.evb pictures/ --speed 0.15 --fps 15 --duration 10 --mode time_surface");
  CHECK(outcome.out == "written: pictures/, 5 pictures of 640x320 pixels\n");
  CHECK(names_in(folder.file("pictures")).size() == 5);
  CHECK_THAT(testing::evbench(folder, "render a.evb pictures/").err,
             ContainsSubstring("pictures/: exists already; --force"));
  CHECK(testing::evbench(folder, "render a.evb a.png --scale 4 --force").exit_code == 0);

  outcome = testing::evbench(folder, "render a.evb a.mp4 --beside a.evb --quiet");
  CHECK(outcome.exit_code == 0);
  CHECK((outcome.out + outcome.err).empty());
  CHECK(names_in(folder.path()) == std::set<std::string>{"a.evb", "a.mp4", "a.png", "pictures"});
}

TEST_CASE("render draws a run's tracks over its events", "[slow]") {
  const TemporaryFolder folder;
  write_recording_of_events(folder);
  folder.write("calib.txt", "20 20 10 5 0 0 0 0 0\n");
  folder.write("c.json", dump_json(short_config()));
  REQUIRE(testing::evbench(folder, "run c.json --tracks --quiet").exit_code == 0);
  const std::filesystem::path made = *runs_of(folder.file("results/short")).begin();
  const std::string run = "results/short/" + made.filename().string();
  CHECK(testing::evbench(folder, "render a.evb plain.png --to 0.05").exit_code == 0);
  CHECK(testing::evbench(folder, "render a.evb run.png --to 0.05 --calib calib.txt --run " + run).exit_code == 0);
  const cv::Mat plain = cv::imread(folder.file("plain.png")), drawn = cv::imread(folder.file("run.png"));
  REQUIRE_FALSE(drawn.empty());
  CHECK((drawn.size() != plain.size() || cv::norm(plain, drawn) > 0.0));
  std::filesystem::remove(folder.file(run + "/tracks.txt"));
  const Outcome without = testing::evbench(folder, "render a.evb none.png --calib calib.txt --run " + run);
  CHECK(without.exit_code == 2);
  CHECK_THAT(without.err, ContainsSubstring("--tracks"));
}

TEST_CASE("render rejects bad input with exit code 2 and a message", "[slow]") {
  const TemporaryFolder folder;
  write_recording_of_events(folder);
  const auto refused = [&](const std::string& arguments, const std::string& message) {
    const Outcome outcome = testing::evbench(folder, "render " + arguments);
    INFO(arguments);
    CHECK(outcome.exit_code == 2);
    CHECK(outcome.out.empty());
    CHECK_THAT(outcome.err, ContainsSubstring(message));
  };
  refused("a.evb a.bmp", "expected .png");
  refused("b.evb a.png", "b.evb");
  refused("a.evb nowhere/a.png", "the folder nowhere is missing");
  refused("a.evb a.png --from 7", "no events");
  refused("a.evb a.png --from 2 --to 1", "expected from < to");
  refused("a.evb a.png --mode foo", "time_surface");
  refused("a.evb a.png --duration 5 --count 5", "--count");
  refused("a.evb a.png --mode compensated", "--trajectory");
  refused("a.evb a.png --tracks none.txt", "none.txt");
  refused("a.evb a.png --fps 0", "--fps");
  refused("a.evb a.evb --force", "a.evb: is also an input");
  CHECK(names_in(folder.path()) == std::set<std::string>{"a.evb"});
}

TEST_CASE("An interrupted video leaves nothing", "[slow]") {
  const TemporaryFolder folder;
  write_recording_of_events(folder);
  for (const char* signal : {"INT", "KILL"}) {
    // Minutes of video: the signal comes first.
    shell(folder,
          std::string("timeout -s ") + signal + " 1 \"$evbench\" render a.evb a.mp4 --speed 0.00002 --scale 32");
    CHECK(names_in(folder.path()) == std::set<std::string>{"a.evb"});
  }
}
