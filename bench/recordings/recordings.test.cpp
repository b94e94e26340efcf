#include <sys/stat.h>

#include <csignal>
#include <filesystem>
#include <fstream>

#include "bench/commands/exit_code.hpp"
#include "bench/recordings/conversion.hpp"
#include "bench/recordings/summary.hpp"
#include "bench/testing/program.hpp"
#include "core/events/formats.hpp"
#include "core/events/native/native.hpp"
#include "core/support/error.hpp"
#include "core/support/interruption.hpp"
#include "core/support/json.hpp"
#include "core/testing/catch2.hpp"

using namespace evbench;
using namespace evbench::testing;
using Catch::Matchers::ContainsSubstring;

namespace {

/// Events from 2 s on, 1 ms apart, that walk over a 240x180 sensor; every third is off.
std::vector<Event> walking_events(std::int64_t count) {
  std::vector<Event> events;
  for (std::int64_t i = 0; i < count; ++i) {
    events.push_back(
        {2000000 + 1000 * i, static_cast<std::uint16_t>(i % 240), static_cast<std::uint16_t>(i % 180), i % 3 != 0});
  }
  return events;
}

RecordingHeader davis_header() {
  RecordingHeader header;
  header.width = 240;
  header.height = 180;
  header.calibration = Camera{{200, 200, 120, 90}, DistortionModel::radial_tangential, {}, 240, 180};
  header.calibration->coefficients << -0.35, 0.12, 0, 0, 0;
  header.ground_truth = PoseTrajectory({{2.0, SE3()}, {3.0, {Eigen::Quaterniond::Identity(), Vector3(0.5, 0, 0)}}});
  return header;
}

void write_native(const std::string& path, const std::vector<Event>& events, const RecordingHeader& header) {
  NativeWriter writer(path, header);
  writer.write(events);
  writer.finish();
}

std::vector<Event> read_all(const std::string& path) {
  EventStream stream(path);
  std::vector<Event> all;
  for (std::vector<Event> events; stream.read(events);) all.insert(all.end(), events.begin(), events.end());
  return all;
}

/// A chunk that does not agree with its checksum.
void damage(const std::string& path) {
  std::string bytes = read_file(path);
  bytes[100] = static_cast<char>(bytes[100] ^ 1);
  std::filesystem::remove(path);
  std::ofstream(path, std::ios::binary) << bytes;
}

}  // namespace

TEST_CASE("info reports a recording's format, sensor, counts, times, rates, calibration and ground truth", "[slow]") {
  const TemporaryFolder folder;
  write_native(folder.file("a.evb"), walking_events(1000), davis_header());
  const Outcome text = testing::evbench(folder, "info a.evb");
  CHECK(text.exit_code == 0);
  CHECK(text.err.empty());
  CHECK_THAT(text.out, ContainsSubstring("evbench native 1") && ContainsSubstring("240x180 pixels") &&
                           ContainsSubstring("1000: 666 on, 334 off (66.6 % on)") &&
                           ContainsSubstring("2.000000 to 2.999000 s: 0.999000 s") &&
                           ContainsSubstring("1001/s on average") && ContainsSubstring("radial_tangential") &&
                           ContainsSubstring("2 poses, 2.000 to 3.000 s, path 0.50 m") &&
                           ContainsSubstring("oddities      none") && ContainsSubstring("█"));
  const Json json = parse_json(testing::evbench(folder, "info a.evb --json").out);
  CHECK(json.at("events") == 1000);
  CHECK(json.at("on") == 666);
  CHECK(json.at("start_us") == 2000000);
  CHECK(json.at("end_us") == 2999000);
  CHECK(json.at("sensor").at("width") == 240);
  CHECK(json.at("calibration").at("fx") == 200.0);
  CHECK(json.at("ground_truth").at("poses") == 2);
  CHECK(json.at("oddities").empty());
}

TEST_CASE("info reports a recording without events, and damage", "[slow]") {
  const TemporaryFolder folder;
  write_native(folder.file("none.evb"), {}, {});
  CHECK_THAT(testing::evbench(folder, "info none.evb").out,
             ContainsSubstring("events        none") && ContainsSubstring("unknown"));
  CHECK(parse_json(testing::evbench(folder, "info none.evb --json").out).at("start_us").is_null());
  write_native(folder.file("a.evb"), walking_events(20000), davis_header());
  damage(folder.file("a.evb"));
  const Outcome damaged = testing::evbench(folder, "info a.evb");
  CHECK_THAT(damaged.out, ContainsSubstring("16384 events in damaged chunks (checksum), left out"));
  CHECK(damaged.exit_code == 2);
  CHECK_THAT(damaged.err, ContainsSubstring("a.evb: 81.9 % of the events, 16384 of 20000, have to be left out") &&
                              ContainsSubstring("(the first: chunk 0 at byte 64)") && ContainsSubstring("--lenient"));
  CHECK(testing::evbench(folder, "info a.evb --lenient").exit_code == 0);
  const Outcome strict = testing::evbench(folder, "info a.evb --strict");
  CHECK(strict.exit_code == 2);
  CHECK_THAT(strict.err, ContainsSubstring("chunk 0 at byte 64"));
  CHECK_THAT(testing::evbench(folder, "info nowhere").err, ContainsSubstring("nowhere"));
}

TEST_CASE("A recording of 100 days still has a histogram, of bounded size, with all its events") {
  RateHistogram histogram;
  std::vector<Event> events;
  for (int i = 0; i < 1000; ++i) events.push_back({i * std::int64_t{8640000000}, 0, 0, true});
  histogram.add(events);
  CHECK(histogram.rates().size() <= RateHistogram::kBins);
  double count = 0.0;
  for (const double rate : histogram.resampled(10)) count += rate * 999 * 8640.0 / 10.0;
  CHECK(count == Approx(1000.0).epsilon(1e-6));
}

TEST_CASE("Rates are plotted in proportion") {
  const std::string plot = plot_rates({0.0, 1e6, 2e6}, 0.0, 3.0, 1);
  CHECK_THAT(plot, ContainsSubstring("million events/s\n") && ContainsSubstring("2.000 | ▄█\n") &&
                       ContainsSubstring("0.000 s"));
  CHECK_THAT(plot_rates({0.0, 4.0, 8.0}, 0.0, 3.0, 1),
             Catch::Matchers::StartsWith("events/s\n") && ContainsSubstring("8 | ▄█\n"));
  CHECK_FALSE(plot_rates({}, 0.0, 0.0).empty());
}

TEST_CASE("convert writes native, text and HDF5 files that read back as the same events", "[slow]") {
  const TemporaryFolder folder;
  const auto events = walking_events(5000);
  write_native(folder.file("a.evb"), events, davis_header());
  for (const char* out : {"b.evb", "b.h5"}) {
    const Outcome outcome = testing::evbench(folder, std::string("convert a.evb ") + out);
    INFO(out << outcome.err);
    CHECK(outcome.exit_code == 0);
    CHECK_THAT(outcome.out, ContainsSubstring(std::string("written: ") + out) && ContainsSubstring("5000 events"));
    CHECK(read_all(folder.file(out)) == events);
  }
  CHECK(testing::evbench(folder, "convert a.evb b --format text --quiet").out.empty());
  CHECK_THAT(read_file(folder.file("b")),
             Catch::Matchers::StartsWith("# t[s] x y p\n# geometry: 240x180\n2.000000 0 0 0\n2.001000 1 1 1\n"));
  const auto reader = open_events(folder.file("b.evb"));
  REQUIRE(reader->calibration());
  CHECK(reader->ground_truth()->size() == 2);
  CHECK(names_in(folder.path()) == std::set<std::string>{"a.evb", "b.evb", "b.h5", "b"});
}

TEST_CASE("Times before zero have a sign in text") {
  const TemporaryFolder folder;
  write_native(folder.file("a.evb"), {{-1500000, 1, 2, true}, {-1, 1, 2, false}, {7, 1, 2, true}}, davis_header());
  convert(folder.file("a.evb"), folder.file("a.txt"), {});
  CHECK(read_file(folder.file("a.txt")) ==
        "# t[s] x y p\n# geometry: 240x180\n-1.500000 1 2 1\n-0.000001 1 2 0\n0.000007 1 2 1\n");
}

TEST_CASE("convert takes a time range, with times from the first event on or as they are", "[slow]") {
  const TemporaryFolder folder;
  write_native(folder.file("a.evb"), walking_events(5000), davis_header());
  REQUIRE(testing::evbench(folder, "convert a.evb b.evb --from 3 --to 4.5").exit_code == 0);
  auto cut = read_all(folder.file("b.evb"));
  CHECK(cut.size() == 1500);
  CHECK(cut.front().t == 3000000);
  CHECK(cut.back().t == 4499000);
  CHECK_THAT(testing::evbench(folder, "info b.evb").out, ContainsSubstring("a part of it: 3.000000 to 4.500000 s"));
  REQUIRE(testing::evbench(folder, "convert a.evb b.evb --force --from 1 --to 2 --rebase").exit_code == 0);
  cut = read_all(folder.file("b.evb"));
  CHECK(cut.size() == 1000);
  CHECK(cut.front().t == 1000000);
  CHECK(open_events(folder.file("b.evb"))->ground_truth()->start() == Approx(0.0).margin(1e-12));
}

TEST_CASE("Text that evbench writes is read as the same events, whatever the first ones are", "[slow]") {
  const TemporaryFolder folder;
  std::vector<Event> events;  // times and pixels that could be of either order, or in microseconds
  for (int i = 0; i < 1500; ++i) events.push_back({0, 1, 1, true});
  for (int i = 0; i < 500; ++i) events.push_back({1000 * i, 1, 0, i % 2 == 0});
  write_native(folder.file("a.evb"), events, davis_header());
  REQUIRE(testing::evbench(folder, "convert a.evb a.txt --quiet").exit_code == 0);
  REQUIRE(testing::evbench(folder, "convert a.txt b.txt --quiet").exit_code == 0);
  CHECK(read_file(folder.file("a.txt")) == read_file(folder.file("b.txt")));
  CHECK(read_all(folder.file("b.txt")) == events);
  CHECK_THAT(testing::evbench(folder, "info b.txt").out, ContainsSubstring("240x180 pixels"));
  REQUIRE(testing::shell(folder, "grep -v '^#' a.txt > bare.txt").exit_code == 0);
  CHECK(read_all(folder.file("bare.txt")) == events);
}

TEST_CASE("A part of a recording keeps its ground truth, and a folder's description names the file", "[slow]") {
  const TemporaryFolder folder;
  RecordingHeader header = davis_header();
  std::vector<StampedPose> poses;
  for (int i = 0; i < 1000; ++i) poses.push_back({0.1 * i, SE3()});
  header.ground_truth = PoseTrajectory(poses);
  write_native(folder.file("a.evb"), walking_events(5000), header);
  std::filesystem::create_directory(folder.file("seq"));
  REQUIRE(testing::evbench(folder, "convert a.evb seq/events.evb --from 3 --to 4").exit_code == 0);
  const auto truth = open_events(folder.file("seq"))->ground_truth();
  REQUIRE(truth);
  CHECK(truth->start() == Approx(2.0));
  CHECK(truth->end() == Approx(5.0));
  CHECK_THAT(testing::evbench(folder, "info seq").out, ContainsSubstring("events in     seq/events.evb") &&
                                                           ContainsSubstring("a part of it: 3.000000 to 4.000000 s"));
}

TEST_CASE("A recording may come from a pipe or the standard input, of any format", "[slow]") {
  const TemporaryFolder folder;
  const auto events = walking_events(5000);
  write_native(folder.file("a.evb"), events, davis_header());
  REQUIRE(testing::evbench(folder, "convert a.evb a.h5 --quiet").exit_code == 0);
  for (const char* const in : {"a.evb", "a.h5"}) {
    INFO(in);
    const std::string command = std::string("cat ") + in + " | \"$evbench\" convert - b.txt --force";
    CHECK(testing::shell(folder, command).exit_code == 0);
    CHECK(read_all(folder.file("b.txt")) == events);
  }
  const Outcome piped = testing::shell(folder, "mkfifo pipe; cat a.evb > pipe & \"$evbench\" info pipe");
  CHECK(piped.exit_code == 0);
  CHECK_THAT(piped.out, ContainsSubstring("file          pipe") && ContainsSubstring("5000: "));
  const Outcome broken = testing::shell(folder, "head -c 100 a.evb | \"$evbench\" info -");
  CHECK(broken.exit_code == 2);
  CHECK_THAT(broken.err,
             ContainsSubstring("evbench info: -: ") && ContainsSubstring("truncated") && !ContainsSubstring("/proc"));
}

TEST_CASE("convert removes lens distortion, and counts events that it leaves out", "[slow]") {
  const TemporaryFolder folder;
  const auto events = walking_events(720);
  write_native(folder.file("a.evb"), events, davis_header());
  ConversionOptions options;
  options.undistort = "own";
  const ConversionReport report = convert(folder.file("a.evb"), folder.file("b.evb"), options);
  const Camera lens = *davis_header().calibration;
  std::vector<Event> expected;
  for (Event event : events) {
    const Vector2 ideal = lens.undistort(Vector2(event.x, event.y)).value();
    if (ideal.x() < -0.5 || ideal.y() < -0.5 || ideal.x() >= 239.5 || ideal.y() >= 179.5) continue;
    event.x = static_cast<std::uint16_t>(ideal.x() + 0.5);
    event.y = static_cast<std::uint16_t>(ideal.y() + 0.5);
    expected.push_back(event);
  }
  CHECK(report.outside > 0);
  CHECK(report.written + report.outside == 720);
  CHECK(read_all(folder.file("b.evb")) == expected);
  CHECK(open_events(folder.file("b.evb"))->calibration()->distortion == DistortionModel::none);
  folder.write("calib.txt", "200 200 120 90 -0.35 0.12 0 0 0\n");
  REQUIRE(testing::evbench(folder, "convert a.evb c.evb --undistort calib.txt").exit_code == 0);
  CHECK(read_all(folder.file("c.evb")) == expected);
  const auto kalibr = [](const char* name, const char* coefficients) {
    return std::string(name) + ": {camera_model: pinhole, intrinsics: [200, 200, 120, 90], distortion_model: radtan, " +
           "distortion_coeffs: [" + coefficients + "], resolution: [240, 180]}\n";
  };
  folder.write("two.yaml", kalibr("cam0", "0, 0, 0, 0") + kalibr("cam1", "-0.35, 0.12, 0, 0"));
  CHECK_THAT(testing::evbench(folder, "convert a.evb d.evb --undistort two.yaml").err,
             ContainsSubstring("holds cam0, cam1"));
  REQUIRE(testing::evbench(folder, "convert a.evb d.evb --undistort two.yaml --camera cam1").exit_code == 0);
  CHECK(read_all(folder.file("d.evb")) == expected);
}

TEST_CASE("convert refuses invalid requests with the reason, and leaves nothing behind", "[slow]") {
  const TemporaryFolder folder;
  write_native(folder.file("a.evb"), walking_events(20000), davis_header());
  write_native(folder.file("unknown.evb"), walking_events(10), {});
  write_native(folder.file("none.evb"), {}, {});
  write_native(folder.file("corner.evb"), {{1, 0, 0, true}}, davis_header());
  folder.write("mistaken.json", R"({"source": {"type": "recording", "events": "a.evb", "calibration": "lens.txt",
                                               "width": 320, "height": 240, "time_range": [2, 3]}})");
  folder.write("lens.txt", "200 200 120 90 -0.35 0.12 0 0 0\n");
  folder.write("ok.txt", "old");
  const auto refused = [&](const std::string& arguments, const std::string& message, int exit_code = kExitBadInput) {
    const Outcome outcome = testing::evbench(folder, "convert " + arguments);
    INFO(arguments);
    CHECK(outcome.exit_code == exit_code);
    CHECK_THAT(outcome.err, ContainsSubstring(message));
  };
  refused("a.evb b.xyz", "expected one of .evb (native)");
  refused("a.evb b --format nativ", "did you mean \"native\"?");
  refused("a.evb b.evb --from 3 --to 2", "expected from < to");
  refused("a.evb b.evb --undistort nowhere.txt", "nowhere.txt");
  refused("unknown.evb b.evb --undistort own", "--width");
  refused("unknown.evb b.evb --undistort own --width 10 --height 10", "no calibration of its own");
  refused("unknown.evb b.evb --undistort calib.txt --width 8000 --height 8001", "64 million pixels at most");
  refused("mistaken.json b.evb --undistort own", "a sensor of 320x240 pixels, the recording one of 240x180");
  refused("a.evb no/b.evb", "no/b.evb: can't be written", kExitNotWritten);
  refused("unknown.evb ok.txt", "ok.txt: exists already; --force replaces it");
  refused("a.evb a.evb --force --to 3", "a.evb: is also an input");
  refused("a.evb ok.txt --force --from 100", "has no events in the time range");
  refused("corner.evb ok.txt --force --undistort lens.txt", "all events lie outside the undistorted image");
  refused("none.evb ok.txt --force", "has no events; nothing was written");
  CHECK(read_file(folder.file("ok.txt")) == "old");
  damage(folder.file("a.evb"));
  refused("a.evb b.evb --strict", "checksum");
  refused("a.evb b.h5 --strict", "checksum");
  refused("a.evb b.evb", "81.9 % of the events, 16384 of 20000, have to be left out");
  CHECK_THAT(testing::evbench(folder, "convert a.evb ok.evb --lenient").out,
             ContainsSubstring("left out: 16384 events in damaged chunks"));
  CHECK(names_in(folder.path()) == std::set<std::string>{"a.evb", "unknown.evb", "none.evb", "corner.evb",
                                                         "mistaken.json", "lens.txt", "ok.txt", "ok.evb"});
}

TEST_CASE("A conversion that is interrupted leaves nothing, and keeps an older file") {
  const TemporaryFolder folder;
  write_native(folder.file("a.evb"), walking_events(100000), davis_header());
  const std::string out = GENERATE("b.txt", "b.h5", "b.evb");
  folder.write(out, "old");
  {
    const Interruption interruption("interrupted");
    const auto interrupt = [](std::int64_t, std::int64_t) { std::raise(SIGINT); };
    CHECK_THROWS_WITH(convert(folder.file("a.evb"), folder.file(out), {}, interrupt), "interrupted");
  }
  CHECK(names_in(folder.path()) == std::set<std::string>{"a.evb", out});
  CHECK(read_file(folder.file(out)) == "old");
}

TEST_CASE("A signal ends a conversion with an error that names it") {
  const TemporaryFolder folder;
  write_native(folder.file("a.evb"), walking_events(100000), davis_header());
  // A pipe that nobody reads holds the program: it is there when the signal comes. Its handler is set by then.
  const Outcome outcome = testing::shell(folder,
                                         "mkfifo b.txt; \"$evbench\" convert a.evb b.txt & exec 3<> b.txt; "
                                         "timeout 60 head -c 1 <&3 > /dev/null; kill -TERM $!; wait $!");
  CHECK(outcome.exit_code == 143);  // as shells say SIGTERM
  CHECK_THAT(outcome.err, ContainsSubstring("b.txt: interrupted; nothing was written"));
}

TEST_CASE("A conversion can be interrupted while no event lies in the range") {
  const TemporaryFolder folder;
  write_native(folder.file("a.evb"), walking_events(100000), davis_header());
  const Interruption interruption("interrupted");
  std::raise(SIGTERM);
  ConversionOptions options;
  options.stream.to = 0;
  CHECK_THROWS_WITH(convert(folder.file("a.evb"), folder.file("b.txt"), options), "interrupted");
  CHECK(names_in(folder.path()) == std::set<std::string>{"a.evb"});
}

TEST_CASE("Text is converted into a pipe, other formats are not", "[slow]") {
  const TemporaryFolder folder;
  write_native(folder.file("a.evb"), walking_events(3), davis_header());
  const Outcome text = testing::shell(folder, "\"$evbench\" convert a.evb /dev/stdout --format text --quiet | cat");
  CHECK(text.out == "# t[s] x y p\n# geometry: 240x180\n2.000000 0 0 0\n2.001000 1 1 1\n2.002000 2 2 1\n");
  const Outcome hdf5 = testing::evbench(folder, "convert a.evb /dev/null --format hdf5");
  CHECK(hdf5.exit_code == 2);
  CHECK_THAT(hdf5.err, ContainsSubstring("/dev/null: is a pipe or a device"));
}

TEST_CASE("A disk that is full while a file is written is an error that names the file", "[slow]") {
  const TemporaryFolder folder;
  std::vector<Event> events;
  std::uint32_t state = 1;
  for (int i = 0; i < 50000; ++i) {
    state = state * 1664525 + 1013904223;
    events.push_back({10 * i + state % 9, static_cast<std::uint16_t>(state >> 8 & 127),
                      static_cast<std::uint16_t>(state >> 16 & 127), state >> 31 != 0});
  }
  write_native(folder.file("a.evb"), events, davis_header());
  const std::string out = GENERATE("b.txt", "b.h5", "b.evb");
  folder.write(out, "old");
  // A limit on the size of files takes the role of a full disk.
  const Outcome outcome = testing::shell(folder, "trap '' XFSZ; ulimit -f 64; \"$evbench\" convert --force a.evb " +
                                                     out + "; code=$?; ulimit -f unlimited; exit $code");
  CHECK(outcome.exit_code == 4);
  CHECK_THAT(outcome.err, ContainsSubstring(out + ": can't be written") && !ContainsSubstring(".part") &&
                              !ContainsSubstring("/proc"));
  CHECK(names_in(folder.path()) == std::set<std::string>{"a.evb", out});
  CHECK(read_file(folder.file(out)) == "old");
}

TEST_CASE("A config is a recording of its source's events, with camera and ground truth", "[slow]") {
  const TemporaryFolder folder;
  const auto write_config = [&](const char* text) { std::ofstream(folder.file("a.json")) << text; };
  write_config(R"({"seed": 3, "source": {"type": "event_simulation", "duration": 0.2,
                   "camera": {"width": 60, "height": 40, "focal_length": 50}, "scene": {"kind": "shapes"}}})");
  const Outcome converted = testing::evbench(folder, "convert a.json a.evb");
  CHECK(converted.err.empty());
  REQUIRE(converted.exit_code == 0);
  const auto recording = open_events(folder.file("a.evb"));
  CHECK(recording->info().width == 60);
  CHECK(recording->info().count.value() > 100);
  REQUIRE(recording->ground_truth());
  CHECK(recording->ground_truth()->end() == Approx(0.2).margin(0.01));
  CHECK(recording->calibration()->height == 40);
  CHECK_THAT(testing::evbench(folder, "info a.json --topic /events").err,
             ContainsSubstring("has neither topics nor columns"));

  write_native(folder.file("b.evb"), walking_events(20000), davis_header());
  damage(folder.file("b.evb"));
  folder.write("calib.txt", "200 200 120 90 0 0 0 0 0\n");
  write_config(R"({"source": {"type": "recording", "events": "b.evb", "calibration": "calib.txt",
                   "width": 240, "height": 180, "time_range": [2, 3]}})");
  CHECK_THAT(testing::evbench(folder, "convert a.json b.txt --force").err, ContainsSubstring("have to be left out"));
  CHECK(testing::evbench(folder, "convert a.json b.txt --force --lenient").exit_code == 0);
  const Outcome strict = testing::evbench(folder, "convert a.json b.txt --force --strict");
  CHECK(strict.exit_code == 2);
  CHECK_THAT(strict.err, ContainsSubstring("a.json") && ContainsSubstring("damaged chunks"));

  write_config(R"({"source": {"type": "simulation"}})");
  const Outcome refused = testing::evbench(folder, "info a.json");
  CHECK(refused.exit_code == 2);
  CHECK_THAT(refused.err, ContainsSubstring("its source has no events"));
}

TEST_CASE("A config that names itself, or one that names it, as its recording is refused with a sentence", "[slow]") {
  const TemporaryFolder folder;
  folder.write("calib.txt", "200 200 120 90 0 0 0 0 0\n");
  const auto write_config = [&](const std::string& name, const std::string& named, const std::string& more) {
    folder.write(name, R"({"source": {"type": "recording", "events": ")" + named + "\"" + more + R"(},
                          "frontend": {"type": "oracle"}, "backend": {"type": "bundle_adjustment"}})");
  };
  const std::string named = GENERATE("a.json", "b.json");
  // Options for which the source reads its events, or does not.
  const std::string more = GENERATE("", R"(, "calibration": "calib.txt", "time_range": [0, 1])");
  write_config("a.json", named, more);
  write_config("b.json", "a.json", more);
  for (const std::string command : {"info a.json", "convert a.json a.evb", "render a.json a.png", "run a.json"}) {
    if (command == "run a.json" && !more.empty()) continue;  // the oracle does not use events
    CAPTURE(command, named, more);
    const Outcome refused = testing::evbench(folder, command);
    CHECK(refused.exit_code == 2);
    CHECK_THAT(refused.err, ContainsSubstring(named + ": is of no known event format; known: native, "));
  }
}
