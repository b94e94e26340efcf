#include "bench/render/render.hpp"

#include <filesystem>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>
#include <set>

#include "bench/render/picture_sink.hpp"
#include "bench/render/testing/recording.hpp"
#include "bench/render/track_overlay.hpp"
#include "core/support/error.hpp"
#include "core/testing/catch2.hpp"

using namespace evbench;
using namespace evbench::testing;
using Catch::Matchers::ContainsSubstring;

namespace {

/// For 100 ms an event a millisecond, from 1 s on; on and off in turn, along the sensor's columns.
std::vector<Event> hundred_events() {
  std::vector<Event> events;
  for (int i = 0; i < 100; ++i) {
    events.push_back(
        {1000000 + 1000 * i, static_cast<std::uint16_t>(i % 20), static_cast<std::uint16_t>(i / 20), i % 2 == 0});
  }
  return events;
}

std::set<std::string> names(const std::string& folder) {
  std::set<std::string> all;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) all.insert(entry.path().filename().string());
  return all;
}

/// Pixels that are not white.
int drawn_pixels(const std::string& path) {
  const Picture picture = cv::imread(path, cv::IMREAD_COLOR);
  int count = 0;
  for (const Colour& colour : picture) count += colour == Colour(255, 255, 255) ? 0 : 1;
  return count;
}

/// All pictures of a video that another program can read.
std::vector<cv::Mat> read_video(const std::string& path) {
  cv::VideoCapture video(path);
  std::vector<cv::Mat> pictures;
  for (cv::Mat picture; video.read(picture);) pictures.push_back(picture.clone());
  return pictures;
}

}  // namespace

TEST_CASE("A picture shows its time where that is requested") {
  const TemporaryFolder folder;
  const std::string in = write_native(folder, "a.evb", hundred_events());
  const auto draw = [&](const std::string& name, bool time, std::int64_t from) {
    RenderOptions options;
    options.time = time;
    options.stream.from = from;
    render(in, folder.file(name), options);
    return Picture(cv::imread(folder.file(name), cv::IMREAD_COLOR));
  };
  const Picture without = draw("without.png", false, 1000000), with = draw("with.png", true, 1000000);
  cv::Mat difference, changed;
  cv::cvtColor(cv::abs(without - with), difference, cv::COLOR_BGR2GRAY);
  cv::findNonZero(difference, changed);
  REQUIRE(changed.total() > 50);
  const cv::Rect box = cv::boundingRect(changed);
  CHECK(box.x < 30);
  CHECK(box.y > with.rows - 30);
  const cv::Rect corner(0, with.rows - 30, 100, 30);
  CHECK(cv::norm(with(corner), draw("later.png", true, 1050000)(corner)) > 0.0);
}

TEST_CASE("A picture shows the events of its duration or count, at any scale") {
  const TemporaryFolder folder;
  const std::string in = write_native(folder, "a.evb", hundred_events()), out = folder.file("a.png");
  RenderOptions options;
  options.scale = 1;
  CHECK(render(in, out, options).size == cv::Size(20, 10));
  CHECK(drawn_pixels(out) == 20);  // 20 ms
  options.count = 7;
  render(in, out, options);
  CHECK(drawn_pixels(out) == 7);
  options.count.reset();
  options.duration = 0.03;
  options.stream.from = 1080000;
  render(in, out, options);
  CHECK(drawn_pixels(out) == 20);  // to the end
  options.duration.reset();
  options.stream.from = 1010000;
  options.stream.to = 1050000;
  render(in, out, options);
  CHECK(drawn_pixels(out) == 40);  // the whole range
  options.scale = 3;
  render(in, out, options);
  CHECK(drawn_pixels(out) == 40 * 9);
  options.scale.reset();
  CHECK(render(in, out, options).size == cv::Size(640, 320));
}

TEST_CASE("The same recording and options give the same bytes") {
  const TemporaryFolder folder;
  const std::string in = write_native(folder, "a.evb", hundred_events());
  folder.write("tracks.txt", "1 1.00 3 4\n1 1.01 5 4\n2 1.01 12 4\n");
  for (const RenderMode mode : {RenderMode::events, RenderMode::time_surface}) {
    RenderOptions options;
    options.mode = mode;
    options.tracks = folder.file("tracks.txt");
    render(in, folder.file("a.png"), options);
    render(in, folder.file("b.png"), options);
    CHECK(read_file(folder.file("a.png")) == read_file(folder.file("b.png")));
  }
}

TEST_CASE("Pictures follow at fractions of a microsecond without drifting, and not faster than one") {
  const TemporaryFolder folder;
  std::vector<Event> events;
  for (int i = 0; i < 100; ++i) events.push_back({i, 1, 1, true});
  const std::string in = write_native(folder, "a.evb", events);
  RenderOptions options;
  options.speed = 1e-4;  // a picture each 3.33 us, of 30 us
  CHECK(render(in, folder.file("out/"), options).pictures == 22);
  options.speed = 1e-5;
  CHECK_THROWS_WITH(render(in, folder.file("out/"), options), ContainsSubstring("0.333 us; expected 1 us or more"));
}

TEST_CASE("Nothing is drawn where the recording or the second one has no events") {
  const TemporaryFolder folder;
  const std::vector<Event> two{{1000000, 1, 1, true}, {2000000, 1, 1, true}}, one{{9000000, 1, 1, true}};
  const std::string in = write_native(folder, "a.evb", two), late = write_native(folder, "late.evb", one);
  const std::string out = folder.file("a.png");
  RenderOptions options;
  options.stream.from = 1500000;
  options.duration = 0.01;
  options.stream.to = 1510000;
  CHECK_THROWS_WITH(render(in, out, options), ContainsSubstring("no events"));
  options = {};
  options.beside = late;
  CHECK_THROWS_WITH(render(in, out, options), ContainsSubstring("late.evb: has no events at the times that are drawn"));
  CHECK_FALSE(std::filesystem::exists(out));
  options.stream.rebase = true;
  CHECK_NOTHROW(render(in, out, options));
}

TEST_CASE("A time surface of a short recording is that of its last event") {
  const TemporaryFolder folder;
  const std::string in = write_native(folder, "a.evb", hundred_events()), out = folder.file("a.png");
  RenderOptions options;
  options.mode = RenderMode::time_surface;
  options.scale = 1;
  render(in, out, options);  // 150 ms from the first event on, though there are but 100
  const Picture picture = cv::imread(out, cv::IMREAD_COLOR);
  CHECK(cv::norm(picture(4, 19) - light_palette().off) < 10.0);  // the last event
}

TEST_CASE("Options of compensation are refused elsewhere") {
  const TemporaryFolder folder;
  const std::string in = write_native(folder, "a.evb", hundred_events());
  RenderOptions options;
  options.depth = 1.0;
  CHECK_THROWS_WITH(render(in, folder.file("a.png"), options), ContainsSubstring("for motion-compensated pictures"));
}

TEST_CASE("A folder gets a picture each speed / fps seconds, until the last event is shown") {
  const TemporaryFolder folder;
  const std::string in = write_native(folder, "a.evb", hundred_events());
  RenderOptions options;
  options.fps = 50.0;
  options.speed = 0.5;  // a picture each 10 ms
  options.duration = 0.01;
  options.scale = 1;
  CHECK(render(in, folder.file("pictures/"), options).pictures == 10);
  CHECK(names(folder.path()) == std::set<std::string>{"a.evb", "pictures"});
  for (int i = 0; i < 10; ++i) CHECK(drawn_pixels(folder.file("pictures/00000" + std::to_string(i) + ".png")) == 10);

  options.speed = 1.0;
  CHECK(render(in, folder.file("pictures"), options).pictures == 6);  // an older one is replaced
  CHECK(names(folder.file("pictures")).size() == 6);
}

TEST_CASE("By default a picture of a video shows at least the time since the last one, at most ten times that") {
  const TemporaryFolder folder;
  const std::string in = write_native(folder, "a.evb", hundred_events());
  const auto drawn = [&](double speed) {
    RenderOptions options;
    options.fps = 1000.0;
    options.speed = speed;
    options.scale = 1;
    render(in, folder.file("pictures/"), options);
    return drawn_pixels(folder.file("pictures/000000.png"));
  };
  CHECK(drawn(50.0) == 50);
  CHECK(drawn(10.0) == 20);
  CHECK(drawn(1.0) == 10);
}

TEST_CASE("A folder that holds anything but rendered pictures is left alone") {
  const TemporaryFolder folder;
  const std::string in = write_native(folder, "a.evb", hundred_events());
  for (const char* name : {"mine.txt", "a.png", "1.png", "0000001png"}) {
    const TemporaryFolder other;
    other.write(name, "x");
    CHECK_THROWS_WITH(render(in, other.path(), {}), ContainsSubstring(name));
    CHECK(names(other.path()) == std::set<std::string>{name});
  }
}

TEST_CASE("A video can be read, with the number of pictures and the colours that were drawn") {
  const TemporaryFolder folder;
  const std::string in = write_native(folder, "a.evb", hundred_events()), out = folder.file("a.mp4");
  RenderOptions options;
  options.fps = 25.0;
  options.speed = 0.1;  // a picture each 4 ms
  options.duration = 0.02;
  options.scale = 16;
  std::vector<std::int64_t> reported;
  const RenderReport report =
      render(in, out, options, [&](std::int64_t pictures, std::int64_t) { reported.push_back(pictures); });
  CHECK(report.pictures == 21);  // from 20 ms on
  CHECK(reported.size() == 21);
  CHECK(reported.back() == 21);
  CHECK(names(folder.path()) == std::set<std::string>{"a.evb", "a.mp4"});
  const std::vector<cv::Mat> video = read_video(out);
  REQUIRE(video.size() == 21);
  CHECK(video[0].size() == cv::Size(320, 160));
  CHECK(cv::VideoCapture(out).get(cv::CAP_PROP_FPS) == Approx(25.0));
  const Picture first = video[0];
  CHECK(cv::norm(first(8, 8), light_palette().on) < 60);
  CHECK(cv::norm(first(8, 24), light_palette().off) < 60);
  CHECK(cv::norm(first(100, 100), light_palette().background) < 20);
}

TEST_CASE("A video of odd size is made even at its borders") {
  const TemporaryFolder folder;
  const std::string out = folder.file("a.mp4");
  const auto sink = open_picture_sink(out, 30.0);
  for (int i = 0; i < 3; ++i) sink->add(Picture(33, 55, Colour(0, 0, 200)));
  sink->finish();
  const std::vector<cv::Mat> video = read_video(out);
  REQUIRE(video.size() == 3);
  CHECK(video[0].size() == cv::Size(56, 34));
}

TEST_CASE("An interrupted rendering leaves nothing, and keeps an older file") {
  const TemporaryFolder folder;
  for (const char* name : {"a.png", "a.mp4", "pictures/"}) {
    open_picture_sink(folder.file(name), 30.0)->add(Picture(16, 16, Colour(0, 0, 0)));
    CHECK(names(folder.path()).empty());
  }
  folder.write("a.mp4", "older");
  open_picture_sink(folder.file("a.mp4"), 30.0)->add(Picture(16, 16, Colour(0, 0, 0)));
  CHECK(read_file(folder.file("a.mp4")) == "older");
}

TEST_CASE("Two recordings are drawn side by side, at the same times") {
  const TemporaryFolder folder;
  const std::string in = write_native(folder, "a.evb", hundred_events()), out = folder.file("a.png");
  RecordingHeader header;
  header.width = 30;
  header.height = 12;
  const std::vector<Event> two{{1005000, 29, 11, true}, {1050000, 3, 3, true}};
  RenderOptions options;
  options.beside = write_native(folder, "b.evb", two, header);
  options.scale = 2;
  CHECK(render(in, out, options).size == cv::Size(40 + 4 + 60, 24));
  const Picture picture = cv::imread(out);
  CHECK(picture(0, 0) == light_palette().on);
  CHECK(picture(23, 103) == light_palette().on);
  CHECK(picture(7, 51) == light_palette().background);  // later
  CHECK(picture(5, 41) == light_palette().frame);
}

TEST_CASE("Tracks are drawn over the recording that they belong to") {
  const TemporaryFolder folder;
  const std::string in = write_native(folder, "a.evb", hundred_events()), out = folder.file("a.png");
  RenderOptions options;
  options.tracks = folder.write("tracks.txt", "4 1.019 10 8\n4 1.5 15 8\n");
  options.scale = 4;
  render(in, out, options);
  const Picture picture = cv::imread(out);
  CHECK(picture(34, 42) == track_colour(4, light_palette()));
}

TEST_CASE("Tracks that are never in view at the drawn times are reported") {
  const TemporaryFolder folder;
  const std::string in = write_native(folder, "a.evb", hundred_events());
  RenderOptions options;
  options.tracks = folder.write("tracks.txt", "1 1.01 5 5\n1 1.02 6 5\n");
  CHECK(render(in, folder.file("a.png"), options).remarks.empty());
  options.stream.from = 1080000;
  options.tail = 0.01;
  const RenderReport report = render(in, folder.file("a.png"), options);
  REQUIRE(report.remarks.size() == 1);
  CHECK_THAT(report.remarks[0], ContainsSubstring("tracks.txt: none of its tracks is in view"));
}

TEST_CASE("The time in a picture is not later than the recording's end") {
  const TemporaryFolder folder;
  const std::string in = write_native(folder, "a.evb", hundred_events());
  const auto draw = [&](double duration) {
    RenderOptions options;
    options.time = true;
    options.duration = duration;
    options.stream.from = 1000000;
    render(in, folder.file("a.png"), options);
    return cv::imread(folder.file("a.png"), cv::IMREAD_COLOR);
  };
  CHECK(cv::norm(draw(0.099001), draw(0.5)) == 0.0);  // both show all, to the last event
  CHECK(cv::norm(draw(0.099001), draw(0.098)) > 0.0);
}

TEST_CASE("A sensor of unknown size is as large as its events need") {
  const TemporaryFolder folder;
  const std::vector<Event> events{{100, 5, 7, true}, {200, 9, 3, false}};
  const std::string in = write_native(folder, "a.evb", events, {});
  RenderOptions options;
  options.scale = 1;
  options.count = 2;
  CHECK(render(in, folder.file("a.png"), options).size == cv::Size(10, 8));
}

TEST_CASE("A recording with ground truth and calibration is compensated by them") {
  const TemporaryFolder folder;
  RecordingHeader header;
  header.width = 20;
  header.height = 10;
  Camera camera;
  camera.pinhole = {20.0, 20.0, 10.0, 5.0};
  camera.width = 20;
  camera.height = 10;
  header.calibration = camera;
  header.ground_truth = PoseTrajectory(std::vector<StampedPose>{{0.5, {}}, {1.5, {}}});
  RenderOptions options;
  options.mode = RenderMode::compensated;
  options.scale = 1;
  const std::string out = folder.file("a.png");
  render(write_native(folder, "own.evb", hundred_events(), header), out, options);
  CHECK(drawn_pixels(out) == 20);

  const std::string bare = write_native(folder, "bare.evb", hundred_events());
  CHECK_THROWS_WITH(render(bare, out, options), ContainsSubstring("bare.evb") && ContainsSubstring("--trajectory"));
  options.trajectory = folder.write("truth.txt", "0.5 0 0 0 0 0 0 1\n1.5 0 0 0 0 0 0 1\n");
  CHECK_THROWS_WITH(render(bare, out, options), ContainsSubstring("bare.evb") && ContainsSubstring("--calib"));
  options.calibration = folder.write("calib.txt", "20 20 10 5 0 0 0 0 0\n");
  render(bare, out, options);
  CHECK(drawn_pixels(out) == 20);
  options.trajectory = folder.write("late.txt", "1.015 0 0 0 0 0 0 1\n1.5 0 0 0 0 0 0 1\n");
  const RenderReport late = render(bare, out, options);
  CHECK(drawn_pixels(out) == 20);
  REQUIRE(late.remarks.size() == 1);
  CHECK_THAT(late.remarks[0], ContainsSubstring("the trajectory begins at 1.015000 s, after the events"));
  options.stream.from = 1000000;
  CHECK_THROWS_WITH(render(bare, out, options), ContainsSubstring("late.txt") && ContainsSubstring("--from"));
}

TEST_CASE("A video is compensated up to the last event, where a trajectory may end, and over times without events") {
  const TemporaryFolder folder;
  std::vector<Event> events = hundred_events();
  std::erase_if(events, [](const Event& event) { return event.t > 1030000 && event.t < 1090000; });
  RenderOptions options;
  options.mode = RenderMode::compensated;
  options.duration = 0.01;
  options.fps = 100.0;
  options.trajectory = folder.write("truth.txt", "1 0 0 0 0 0 0 1\n1.0991 0 0 0 0 0 0 1\n");
  options.calibration = folder.write("calib.txt", "20 20 10 5 0 0 0 0 0\n");
  CHECK(render(write_native(folder, "a.evb", events), folder.file("a/"), options).pictures == 10);
}

TEST_CASE("Invalid input or output is refused with a sentence, and nothing is written") {
  const TemporaryFolder folder;
  const std::string in = write_native(folder, "a.evb", hundred_events());
  const auto refused = [&](const std::string& out, const RenderOptions& options, const std::string& message) {
    CHECK_THROWS_WITH(render(in, folder.file(out), options), ContainsSubstring(message));
    CHECK_THROWS_AS(render(in, folder.file(out), options), InputError);
  };
  RenderOptions nothing;
  nothing.stream.from = 5000000;
  for (const char* out : {"a.png", "a.mp4", "a/"}) refused(out, nothing, "a.evb: has no events in the time range");
  for (const char* out : {"no/a.png", "no/a.mp4", "no/a/"}) refused(out, {}, "is missing");
  refused("a.gif", {}, "expected .png");
  refused("a", {}, "expected .png");
  RenderOptions missing;
  missing.beside = folder.file("nowhere.evb");
  refused("a.png", missing, "nowhere.evb");
  CHECK(names(folder.path()) == std::set<std::string>{"a.evb"});
}

TEST_CASE("A clock that jumps by days is refused, not drawn") {
  const TemporaryFolder folder;
  const std::vector<Event> events{{0, 1, 1, true}, {1'000'000'000'000, 2, 2, true}};
  CHECK_THROWS_WITH(render(write_native(folder, "a.evb", events), folder.file("a.mp4"), {}),
                    ContainsSubstring("1000000.000000 s"));
  CHECK(names(folder.path()) == std::set<std::string>{"a.evb"});
}

TEST_CASE("Times that end before a trajectory begins are refused, and an empty range has no events") {
  const TemporaryFolder folder;
  const std::string in = write_native(folder, "a.evb", hundred_events());
  RenderOptions options;
  options.mode = RenderMode::compensated;
  options.trajectory = folder.write("late.txt", "1.05 0 0 0 0 0 0 1\n1.5 0 0 0 0 0 0 1\n");
  options.calibration = folder.write("calib.txt", "20 20 10 5 0 0 0 0 0\n");
  options.stream.to = 1020000;
  CHECK_THROWS_WITH(render(in, folder.file("a.png"), options),
                    ContainsSubstring("the trajectory begins at 1.050000 s"));
  EventStream stream(in, {.from = 1050000, .to = 1020000});
  std::vector<Event> events;
  CHECK_FALSE(stream.read(events));
}
