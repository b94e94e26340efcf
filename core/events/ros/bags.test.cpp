#include <cstdlib>
#include <filesystem>

#include "core/events/testing/mcap_writer.hpp"
#include "core/events/testing/recordings.hpp"

using namespace evbench;
using namespace evbench::testing::mcap_writer;

namespace {

const std::string kBag = "formats/event_camera_py/test_events_1.bag",
                  kDb3 = "formats/event_camera_py/test_events_1.db3",
                  kMcap = "formats/event_camera_py/test_events_2_0.mcap",
                  kTrigger = "formats/event_camera_codecs/test_data_evt3_trigger_0.db3",
                  kLibcaer = "formats/event_camera_codecs/libcaer_rollover_0.db3";

}  // namespace

TEST_CASE("The same recording in a ROS 1 bag and a ROS 2 bag gives the same events") {
  const auto bag = testing::data_file(kBag), db3 = testing::data_file(kDb3);
  if (!bag || !db3) return;
  const auto events = testing::read_all(*bag);
  CHECK(events.size() == 343'474);
  CHECK(events.front().t == 7'139'845);
  CHECK(events.back().t == 9'218'023);
  CHECK(events == testing::read_all(*db3));
  const auto reader = open_events(*bag);
  CHECK(reader->info().width == 640);
  CHECK(reader->info().topics ==
        std::vector<std::string>{"/event_camera/events (event_camera_msgs/EventPacket), 517 messages"});
}

TEST_CASE("Messages that say how they are padded are read as those that don't") {
  const auto db3 = testing::data_file(kDb3);
  if (!db3) return;
  const testing::TemporaryFolder folder;
  std::filesystem::copy_file(*db3, folder.file("padded.db3"));
  const std::string script = folder.write("pad.py",
                                          "import sqlite3, sys\n"
                                          "file = sqlite3.connect(sys.argv[1])\n"
                                          "file.create_function('padded', 1, lambda d: d[:3] + b'\\3' + d[4:])\n"
                                          "file.execute('UPDATE messages SET data = padded(data)')\n"
                                          "file.commit()\n");
  REQUIRE(std::system(("/usr/bin/python3 " + script + " " + folder.file("padded.db3")).c_str()) == 0);
  const auto reader = open_events(folder.file("padded.db3"));
  CHECK(testing::read_all(*reader) == testing::read_all(*db3));
  CHECK(reader->faults().empty());
}

TEST_CASE("EVT 3 packets with triggers decode to the sums that event_camera_codecs tests for") {
  const auto path = testing::data_file(kTrigger);
  if (!path) return;
  const auto sums = testing::sums(testing::read_all(*path));
  CHECK(sums.t == 1'222'326'831'810);
  CHECK(sums.x == 42'078'718);
  CHECK(sums.y == 31'656'267);
  CHECK(sums.on == 41'439);
}

TEST_CASE("libcaer's encodings decode to events in order, in the sensor, and in the time of the recording") {
  const auto [name, count, duration] =
      GENERATE(std::make_tuple(kLibcaer, 334'331, 1'999'986), std::make_tuple(kMcap, 571'266, 999'996));
  const auto path = testing::data_file(name);
  if (!path) return;
  const auto reader = open_events(*path);
  const auto events = testing::read_all(*reader);
  const auto& info = reader->info();
  CHECK(static_cast<int>(events.size()) == count);
  CHECK(events.back().t - events.front().t == duration);
  CHECK(std::is_sorted(events.begin(), events.end(), [](const Event& a, const Event& b) { return a.t < b.t; }));
  CHECK(
      std::all_of(events.begin(), events.end(), [&](const Event& e) { return e.x < info.width && e.y < info.height; }));
  CHECK(reader->faults().empty());
}

TEST_CASE("Bags of each container are sought") {
  const std::string name = GENERATE(kBag, kDb3, kMcap, kTrigger, kLibcaer);
  CAPTURE(name);
  if (const auto path = testing::data_file(name)) testing::check_seeking(*path);
}

TEST_CASE("Bags cut short anywhere are refused, or read as far as they go with a fault") {
  const std::string name = GENERATE(kBag, kMcap);
  CAPTURE(name);
  const testing::TemporaryFolder folder;
  if (const auto path = testing::data_file(name)) testing::check_truncation(folder, *path, 25);
}

TEST_CASE("Bags with broken bytes anywhere are never a crash", "[slow]") {
  const std::string name = GENERATE(kBag, kTrigger, kMcap);
  CAPTURE(name);
  const testing::TemporaryFolder folder;
  if (const auto path = testing::data_file(name)) testing::check_corruption(folder, *path, 60, 5000);
}

TEST_CASE("A ROS 2 bag in SQLite that is cut short is refused or gives the beginning of its events") {
  const auto path = testing::data_file(GENERATE(kTrigger, kDb3));
  if (!path) return;
  const testing::TemporaryFolder folder;
  const std::string whole = testing::read_file(*path);
  const auto all = testing::read_all(*path);
  std::vector<std::size_t> sizes;
  for (std::size_t i = 1; i < 20; ++i) sizes.push_back(whole.size() * i / 20);
  for (const std::size_t missing : {1, 100, 4096, 5000, 12288}) sizes.push_back(whole.size() - missing);
  for (const std::size_t size : sizes) {
    CAPTURE(size, whole.size());
    const std::string cut = folder.write("cut.db3", whole.substr(0, size));
    try {
      const auto reader = open_events(cut);
      const auto events = testing::read_all(*reader);
      CHECK(std::equal(events.begin(), events.end(), all.begin()));
      CHECK_FALSE(reader->faults().empty());
    } catch (const InputError&) {
    }
  }
  CHECK_THROWS_AS(open_events(folder.write("other.db3", std::string("SQLite format 3\0", 16) + "?")), InputError);
}

TEST_CASE("A ROS 2 bag in SQLite is read whatever the characters of its path") {
  const auto path = testing::data_file(kTrigger);
  if (!path) return;
  const testing::TemporaryFolder folder;
  const std::string name = "100 %41?mode=rw#a.db3";
  std::filesystem::copy_file(*path, folder.file(name));
  const std::size_t events = testing::read_all(*path).size();
  for (const std::string before : {"", "/", "//"}) {
    CHECK(testing::read_all(before + folder.file(name)).size() == events);
  }
}

TEST_CASE("MCAP without a summary is read, in chunks of each compression and without chunks") {
  const std::string compression = GENERATE("", "lz4", "zstd", "unchunked");
  CAPTURE(compression);
  const testing::TemporaryFolder folder;
  std::string records = topics() + message(9, 1, packet(100)) + message(8, 1, "?") + message(9, 2, packet(110));
  if (compression != "unchunked")
    records = chunk(compression, records) + chunk(compression, message(9, 3, packet(120)));
  const auto reader = open_events(folder.write("a", mcap(records)));
  const auto events = testing::read_all(*reader);
  REQUIRE(events.size() == (compression == "unchunked" ? 2 : 3));
  CHECK(events[1] == Event{7'000'110, 3, 4, true});
  CHECK(reader->info().width == 346);
  REQUIRE(reader->faults().all().size() == 1);
  CHECK(reader->faults().all().begin()->first == "no summary: the recording was not closed, or is cut short");
}

TEST_CASE("MCAP: lengths of gigabytes, broken chunks and unread encodings are passed over and counted") {
  const testing::TemporaryFolder folder;
  std::string bomb = chunk("zstd", message(9, 2, packet(110)));
  bomb.replace(9 + 16, 8, bytes<std::uint64_t>(std::uint64_t{1} << 40));  // its uncompressed size
  const std::string records = topics() + message(9, 1, packet(100)) + bomb + message(9, 3, packet(120, "mono")) +
                              message(9, 4, packet(130).substr(0, 60)) + message(9, 5, packet(140)) + "\x05" +
                              bytes<std::uint64_t>(std::uint64_t{1} << 62) + "the end";
  const auto reader = open_events(folder.write("a", mcap(records)));
  const auto events = testing::read_all(*reader);
  REQUIRE(events.size() == 2);
  CHECK(events[1].t == 7'000'140);
  const auto& faults = reader->faults().all();
  CHECK(faults.at("broken chunks").count >= 1);
  CHECK(faults.at("broken messages").count == 1);
  CHECK(faults.at("packets of encoding 'mono', which evbench doesn't read").count == 1);
  CHECK(faults.at("broken or cut records, where reading ends").count >= 1);
}

TEST_CASE("A bag without events is refused and its topics are named") {
  const testing::TemporaryFolder folder;
  const std::string images =
      record(3, bytes<std::uint16_t>(1) + text("sensor_msgs/msg/Image") + text("ros2msg") + text("")) +
      record(4, bytes<std::uint16_t>(2) + bytes<std::uint16_t>(1) + text("/image") + text("cdr") + text(""));
  CHECK_THROWS_WITH(open_events(folder.write("a", mcap(images))),
                    Catch::Matchers::ContainsSubstring("/image (sensor_msgs/Image)"));
  CHECK_THROWS_WITH(open_events(folder.write("b", mcap(""))), Catch::Matchers::ContainsSubstring("found: nothing"));
  CHECK_THROWS_WITH(open_events(folder.write("c", mcap(topics())), {.topic = "/other"}),
                    Catch::Matchers::ContainsSubstring("/events"));
}

TEST_CASE("A ROS 1 bag that python's rosbag wrote, of each compression, gives events, ground truth and calibration",
          "[slow]") {
  const std::string python = "/usr/bin/python3 ", compression = GENERATE("none", "lz4", "bz2");
  if (std::system((python + "-c 'import rosbag' 2>/dev/null").c_str()) != 0) {
    WARN("SKIPPED: needs Debian's package python3-rosbag");
    return;
  }
  const testing::TemporaryFolder folder;
  const std::string script = folder.write("write.py", R"(
import sys, struct, rosbag, genpy
def kind(name):
    return type('M', (), {'_type': name, '_md5sum': '0' * 32, '_full_text': 'int8 x'})
def header(t): return struct.pack('<III', 0, int(t), round(t % 1 * 1e9)) + struct.pack('<I', 3) + b'cam'
with rosbag.Bag(sys.argv[1], 'w', compression=sys.argv[2], chunk_threshold=5000) as bag:
    def write(topic, name, t, data):
        bag.write(topic, (name, data, '0' * 32, kind(name)), genpy.Time.from_sec(t), raw=True)
    D, K = (-0.4, 0.2, 0.001, 0.002, 0.0), (199.0, 0, 132.0, 0, 198.0, 110.0, 0, 0, 1)
    write('/dvs/camera_info', 'sensor_msgs/CameraInfo', 100, header(100) + struct.pack('<II', 180, 240)
          + struct.pack('<I', 9) + b'plumb_bob' + struct.pack('<I5d', 5, *D) + struct.pack('<9d', *K) + b'\0' * 200)
    for i in range(100):
        t = 100 + 0.01 * i
        events = b''.join(struct.pack('<HHIIB', k, i, 100, i * 10000000 + k * 1000, k % 2) for k in range(50))
        write('/dvs/events', 'dvs_msgs/EventArray', t + 0.01, header(t) + struct.pack('<III', 180, 240, 50) + events)
        write('/dvs/imu', 'sensor_msgs/Imu', t, header(t))
        write('/optitrack/davis', 'geometry_msgs/PoseStamped', t, header(t) + struct.pack('<7d', i, 2, 3, 0, 0, 0, 1))
    write('/optitrack/davis', 'geometry_msgs/PoseStamped', 101, header(101) + struct.pack('<7d', 1, 2, 3, 0, 0, 0, 0))
)");
  const std::string path = folder.file("recording");
  REQUIRE(std::system((python + script + " " + path + " " + compression + " 2>/dev/null").c_str()) == 0);
  const auto reader = open_events(path);
  CHECK(reader->info().topics.size() == 4);
  CHECK(reader->info().height == 180);
  const auto events = testing::read_all(*reader);
  REQUIRE(events.size() == 5000);
  CHECK(events[151] == Event{100'030'001, 1, 3, true});
  testing::check_seeking(path);

  const auto truth = reader->ground_truth();
  REQUIRE(truth);
  REQUIRE(truth->size() == 100);
  CHECK(truth->poses()[40].t == Approx(100.4).epsilon(1e-12));
  CHECK(truth->poses()[40].T.p == Vector3(40, 2, 3));
  CHECK(reader->faults().all().size() == 1);
  const auto camera = reader->calibration();
  REQUIRE(camera);
  CHECK(camera->pinhole.cy == 110.0);
  CHECK(camera->coefficients[3] == 0.002);
  CHECK(camera->width == 240);
  CHECK_THROWS_WITH(open_events(path, {.topic = "/dvs/imu"}), Catch::Matchers::ContainsSubstring("/dvs/events"));
}
