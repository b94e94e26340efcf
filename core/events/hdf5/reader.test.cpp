#include <hdf5.h>
#include <zstd.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <limits>

#include "core/testing/catch2.hpp"

#if defined(EVBENCH_SANITIZED)
#include <sanitizer/lsan_interface.h>
#endif

#include "core/events/formats.hpp"
#include "core/events/hdf5/filters.hpp"
#include "core/events/testing/hdf5_writer.hpp"
#include "core/events/testing/reading.hpp"
#include "core/support/error.hpp"
#include "core/testing/data.hpp"

using namespace evbench;
using testing::read_all;

namespace {

using Writer = testing::Hdf5Writer;

/// A made-up recording: 150,000 events, 3 µs apart, from 5 ms on.
constexpr std::size_t kCount = 150'000;
Event nth(std::size_t i) {
  return {5000 + 3 * static_cast<std::int64_t>(i), static_cast<std::uint16_t>(i % 640),
          static_cast<std::uint16_t>(i % 479), i % 3 == 0};
}

struct Columns {
  std::vector<std::uint16_t> x, y;
  std::vector<std::uint32_t> t;
  std::vector<std::uint8_t> p;
  std::vector<std::uint64_t> ms_to_idx;
};

Columns columns() {
  Columns c;
  for (std::size_t i = 0; i < kCount; ++i) {
    const Event event = nth(i);
    c.x.push_back(event.x);
    c.y.push_back(event.y);
    c.t.push_back(static_cast<std::uint32_t>(event.t));
    c.p.push_back(event.on);
    while (static_cast<std::int64_t>(c.ms_to_idx.size()) * 1000 <= event.t) c.ms_to_idx.push_back(i);
  }
  return c;
}

void write_columns(Writer& file, const std::string& group, H5Z_filter_t filter = 0) {
  const Columns c = columns();
  file.add(group + "x", c.x, 0, filter);
  file.add(group + "y", c.y, 0, filter);
  file.add(group + "t", c.t, 0, filter);
  file.add(group + "p", c.p, 0, filter);
}

void check_recording(const std::vector<Event>& events, std::int64_t offset = 0) {
  REQUIRE(events.size() == kCount);
  std::size_t different = 0;
  for (std::size_t i = 0; i < kCount; ++i) {
    Event expected = nth(i);
    expected.t += offset;
    different += events[i] == expected ? 0 : 1;
  }
  CHECK(different == 0);
}

bool has_filter(H5Z_filter_t filter) { return H5Zfilter_avail(filter) > 0; }

}  // namespace

TEST_CASE("DSEC's layout is read with its offset, and sought by its index") {
  const testing::TemporaryFolder folder;
  const std::string path = folder.file("events.h5");
  constexpr std::int64_t kOffset = 59'000'000'000;
  {
    Writer file(path);
    write_columns(file, "events/");
    file.add("ms_to_idx", columns().ms_to_idx);
    file.add("t_offset", std::vector<std::int64_t>{kOffset});
  }
  const auto reader = open_events(path);
  CHECK(reader->info().format == "HDF5 (DSEC)");
  CHECK(reader->info().width == 640);
  CHECK(reader->info().count == kCount);
  CHECK(reader->info().start == kOffset + 5000);
  CHECK(reader->info().end == kOffset + 5000 + 3 * (kCount - 1));
  CHECK(reader->info().topics.size() == 6);
  check_recording(read_all(*reader), kOffset);

  std::vector<Event> events;
  for (const std::int64_t t : {0, 5000, 5001, 5003, 6000, 123'456, 454'997}) {
    CAPTURE(t);
    reader->seek(kOffset + t);
    REQUIRE(reader->read(events));
    const auto found = std::find_if(events.begin(), events.end(), [&](const Event& e) { return e.t >= kOffset + t; });
    REQUIRE(found != events.end());
    CHECK(found - events.begin() < 400);  // within the millisecond
    CHECK((found == events.begin() ? events[0].t - kOffset == 5000 || t % 1000 == 0 : (found - 1)->t < kOffset + t));
  }
  reader->seek(kOffset + 500'000);
  CHECK_FALSE(reader->read(events));
}

TEST_CASE("A wrong index of milliseconds does not mislead seeking") {
  const testing::TemporaryFolder folder;
  {
    Writer file(folder.file("events.h5"));
    write_columns(file, "events/");
    file.add("ms_to_idx", std::vector<std::uint64_t>(1000, 149'000));
  }
  const auto reader = open_events(folder.file("events.h5"));
  CHECK(reader->info().format == "HDF5 (TUM-VIE)");
  reader->seek(10'001);
  std::vector<Event> events;
  REQUIRE(reader->read(events));
  CHECK(events.front() == nth(1667));
}

TEST_CASE("MVSEC's rows of doubles are read, with the ground truth in the file next to it") {
  const testing::TemporaryFolder folder;
  constexpr double kStart = 1506117912.0;
  {
    Writer file(folder.file("indoor_flying1_data.hdf5"));
    std::vector<double> rows;
    for (int i = 0; i < 1000; ++i) {
      rows.insert(rows.end(), {double(i % 346), double(i % 260), kStart + 1e-5 * i, i % 2 == 0 ? 1.0 : -1.0});
    }
    file.add("davis/left/events", rows, 4);
    rows[4 * 7] = -1.0;
    rows[4 * 9 + 2] = std::nan("");
    file.add("davis/right/events", rows, 4);
    Writer truth(folder.file("indoor_flying1_gt.hdf5"));
    truth.add("davis/left/pose", std::vector<double>{0, -1, 0, 1, 1, 0, 0, 2, 0, 0, 1, 3, 0, 0, 0, 1}, 16);
    truth.add("davis/left/pose_ts", std::vector<double>{kStart});
  }
  const std::string path = folder.file("indoor_flying1_data.hdf5");
  const auto left = open_events(path);
  CHECK(left->info().format == "HDF5 (MVSEC)");
  CHECK(left->info().height == 260);
  auto events = read_all(*left);
  REQUIRE(events.size() == 1000);
  CHECK(events[3] == Event{1506117912000030, 3, 3, false});
  left->seek(1506117912000031);
  REQUIRE(left->read(events));
  CHECK(events[0] == Event{1506117912000040, 4, 4, true});

  const auto truth = left->ground_truth();
  REQUIRE(truth);
  REQUIRE(truth->size() == 1);
  CHECK(truth->poses()[0].T.p == Vector3(1, 2, 3));
  CHECK((truth->poses()[0].T * Vector3::UnitX()).isApprox(Vector3(1, 3, 3)));

  const auto right = open_events(path, {.topic = "/davis/right"});
  CHECK(read_all(*right).size() == 998);
  REQUIRE(right->faults().all().size() == 1);
  CHECK(right->faults().all().begin()->second.count == 2);
  const auto strict = open_events(path, {.topic = "davis/right/events", .strict = true});
  CHECK_THROWS_AS(read_all(*strict), InputError);
  CHECK_THROWS_WITH(open_events(path, {.topic = "davis/top"}), Catch::Matchers::ContainsSubstring("davis/left/events"));
}

TEST_CASE("M3ED's cameras are chosen by name and bring their calibration") {
  const testing::TemporaryFolder folder;
  const std::string path = folder.file("spot.h5");
  {
    Writer file(path);
    write_columns(file, "prophesee/left/");
    write_columns(file, "prophesee/right/");
    file.add("prophesee/right/calib/intrinsics", std::vector<double>{1000, 1001, 640, 360});
    file.add("prophesee/right/calib/distortion_coeffs", std::vector<double>{-0.1, 0.2, 0.001, 0.002});
    file.add("prophesee/right/calib/resolution", std::vector<std::int64_t>{1280, 719});
  }
  CHECK(open_events(path)->info().metadata.front().second == "/prophesee/left");
  CHECK_FALSE(open_events(path)->calibration());
  const auto right = open_events(path, {.topic = "prophesee/right"});
  CHECK(right->info().format == "HDF5 (M3ED)");
  CHECK(right->info().height == 719);
  const auto camera = right->calibration();
  REQUIRE(camera);
  CHECK(camera->pinhole.fy == 1001.0);
  CHECK(camera->coefficients[3] == 0.002);
  check_recording(read_all(*right));
}

TEST_CASE("Events with an unusable calibration are read, and the calibration is refused when it is requested") {
  const testing::TemporaryFolder folder;
  const std::string path = folder.file("spot.h5");
  {
    Writer file(path);
    write_columns(file, "prophesee/left/");
    file.add("prophesee/left/calib/intrinsics", std::vector<double>{0, 1001, 640, 360});
    file.add("prophesee/left/calib/distortion_coeffs", std::vector<double>{-0.1, 0.2, 0.001, 0.002});
    file.add("prophesee/left/calib/resolution", std::vector<std::int64_t>{1280, 719});
  }
  folder.write("cam_to_cam.yaml", "intrinsics: {}\n");
  const auto reader = open_events(path);
  check_recording(read_all(*reader));
  CHECK(reader->info().height == 720);  // M3ED's
  CHECK_THROWS_WITH(reader->calibration(), Catch::Matchers::ContainsSubstring("calib/: has fx fy cx cy 0 1001"));
}

TEST_CASE("Columns at the root are read in chunks, as they are and through deflate, blosc and lz4") {
#if defined(EVBENCH_SANITIZED)
  const __lsan::ScopedDisabler unwatched;  // HDF5's blosc plugin never frees its buffers, and is unloaded with them
#endif
  const H5Z_filter_t filter = GENERATE(-1, 1, 32001, 32004);
  CAPTURE(filter);
  if (filter > 0) REQUIRE(has_filter(filter));
  const testing::TemporaryFolder folder;
  {
    Writer file(folder.file("events.h5"));
    write_columns(file, "", filter);
  }
  const auto reader = open_events(folder.file("events.h5"), {.width = 640, .height = 480});
  CHECK(reader->info().format == "HDF5 (x, y, t, p)");
  CHECK(reader->info().width == 640);
  check_recording(read_all(*reader));
  reader->seek(123'456);
  std::vector<Event> events;
  REQUIRE(reader->read(events));
  CHECK(events.front().t == 123'458);
}

TEST_CASE("Chunks that are compressed with zstd are read, and those with broken ones refused") {
  const bool broken = GENERATE(false, true);
  const testing::TemporaryFolder folder;
  const std::string path = folder.file("events.h5");
  const std::vector<std::uint16_t> pixels{1, 2, 3, 4, 5, 6, 7, 8};
  std::vector<char> chunk(ZSTD_compressBound(16));
  chunk.resize(ZSTD_compress(chunk.data(), chunk.size(), pixels.data(), 16, 1));
  if (broken) chunk.resize(chunk.size() - 3);
  {
    Writer file(path);
    file.add("y", pixels);
    file.add("t", std::vector<std::int64_t>{1, 2, 3, 4, 5, 6, 7, 8});
    file.add("p", std::vector<std::uint8_t>(8, 1));
    file.add("x", pixels, 0, 32015);
    file.write_chunk("x", chunk);
  }
  const auto reader = open_events(path);
  if (broken) {
    CHECK_THROWS_WITH(read_all(*reader), Catch::Matchers::ContainsSubstring("/x: rows 0 to 7 are broken"));
  } else {
    CHECK(read_all(*reader).at(7) == Event{8, 8, 8, true});
  }
}

TEST_CASE("LZF literals and overlapping copies are decompressed, and broken ones refused") {
  const auto bytes = [](std::initializer_list<int> values) {
    std::vector<std::byte> result;
    for (const int value : values) result.push_back(static_cast<std::byte>(value));
    return result;
  };
  const auto packed = bytes({1, 'a', 'b', 0x20 | 0, 1, 0xE0, 2, 0});  // "ab", 3 from 2 back, 11 from 1 back
  const auto text = hdf5::decompress_lzf(packed, 100);
  REQUIRE(text);
  CHECK(*text == bytes({'a', 'b', 'a', 'b', 'a', 'a', 'a', 'a', 'a', 'a', 'a', 'a', 'a', 'a', 'a', 'a'}));
  CHECK_FALSE(hdf5::decompress_lzf(packed, 15));
  CHECK_FALSE(hdf5::decompress_lzf(bytes({3, 'a'}), 100));
  CHECK_FALSE(hdf5::decompress_lzf(bytes({0, 'a', 0x20, 5}), 100));
  CHECK_FALSE(hdf5::decompress_lzf(bytes({0, 'a', 0xE0, 5}), 100));
}

TEST_CASE("A filter that is not installed is named") {
  const testing::TemporaryFolder folder;
  constexpr H5Z_filter_t kUnknown = 32'767;
  {
    Writer file(folder.file("events.h5"));
    write_columns(file, "", kUnknown);
  }
  CHECK_THROWS_WITH(open_events(folder.file("events.h5")),
                    Catch::Matchers::ContainsSubstring("filter 32767") && Catch::Matchers::ContainsSubstring("/x"));
}

TEST_CASE("A file that python's h5py wrote is read") {
  const testing::TemporaryFolder folder;
  const std::string script = folder.write("write.py", R"(
import sys, h5py, numpy as np
i = np.arange(150000)
with h5py.File(sys.argv[1], 'w') as f:
    f.create_dataset('events/xs', data=(i % 640).astype(np.int16), compression='lzf', chunks=True)
    f.create_dataset('events/ys', data=(i % 479).astype('>i4'))
    f.create_dataset('events/ts', data=(5000 + 3 * i) * 1e-6, compression='gzip', shuffle=True)
    f.create_dataset('events/ps', data=(i % 3 == 0))
    f['events'].attrs['width'], f['events'].attrs['height'] = 640, 480
with h5py.File(sys.argv[1] + '.2', 'w') as f:
    for name in 'xytp': f['events/' + name] = i % 2
    f.attrs['sensor_resolution'] = [260, 346]
)");
  const std::string path = folder.file("python.h5"), python = "/usr/bin/python3 ";
  if (std::system((python + "-c 'import h5py' 2>/dev/null").c_str()) != 0) {
    WARN("SKIPPED: needs Debian's package python3-h5py");
    return;
  }
  REQUIRE(std::system((python + script + " " + path).c_str()) == 0);
  const auto reader = open_events(path);
  CHECK(reader->info().width == 640);
  check_recording(read_all(*reader));
  CHECK(open_events(path + ".2")->info().width == 346);
  CHECK_FALSE(open_events(path + ".2")->info().size_assumed);
}

TEST_CASE("HDF5 files without events, of other shapes, or broken are refused with a sentence, never a crash",
          "[slow]") {
  const testing::TemporaryFolder folder;
  {
    Writer file(folder.file("none.h5"));
    file.add("images/x", std::vector<double>{1.0});
  }
  CHECK_THROWS_WITH(open_events(folder.file("none.h5")), Catch::Matchers::ContainsSubstring("has no events"));
  {
    Writer file(folder.file("rows.h5"));
    file.add("davis/left/events", std::vector<double>(15), 5);
  }
  CHECK_THROWS_WITH(open_events(folder.file("rows.h5")), Catch::Matchers::ContainsSubstring("float64 x 5"));
  {
    Writer file(folder.file("short.h5"));
    write_columns(file, "", 1);
    file.add("other/x", columns().x);
  }
  const std::string whole = testing::read_file(folder.file("short.h5"));
  for (std::size_t length = 9; length < whole.size(); length += whole.size() / 40) {
    CHECK_THROWS_AS(open_events(folder.write("cut.h5", whole.substr(0, length))), InputError);
  }
  int refused = 0;
  for (std::size_t at = 0; at < whole.size(); at += whole.size() / 200) {
    std::string broken = whole;
    for (std::size_t i = at; i < std::min(at + 8, broken.size()); ++i) broken[i] = static_cast<char>(~broken[i]);
    try {
      const auto reader = open_events(folder.write("broken.h5", broken));
      read_all(*reader);
    } catch (const InputError&) {
      ++refused;
    }
  }
  CHECK(refused > 0);
}

TEST_CASE("Columns are read whatever numbers they have, and events that are no pixel or no time are counted") {
  const double nan = std::nan("");
  const testing::TemporaryFolder folder;
  {
    Writer file(folder.file("numbers.h5"));
    file.add("a/x", std::vector<std::int64_t>{1, -1, 65535, 65536, 5, 6, 7});
    file.add("a/y", std::vector<double>{1, 2, 65535, 4, nan, 65535.5, 7});
    file.add("a/t", std::vector<double>{-0.0000014, 2, 1e9, 4, 5, 6, nan});
    file.add("a/p", std::vector<double>{-1, 1, 1, 1, 1, 1, 1});
    file.add("b/x", std::vector<std::uint8_t>{1, 2, 255});
    file.add("b/y", std::vector<std::uint32_t>{1, 2, 70'000});
    file.add("b/t", std::vector<std::uint64_t>{0, 1ull << 63, 3});
    file.add("b/p", std::vector<std::int64_t>{-1, 1, 1});
    file.add("c/x", std::vector<std::uint16_t>{1, 2, 3});
    file.add("c/y", std::vector<std::uint16_t>{4, 5, 6});
    file.add("c/t", std::vector<std::int64_t>{-7, std::numeric_limits<std::int64_t>::min(), 1'000'000'000'000'000'000});
    file.add("c/p", std::vector<std::int8_t>{1, -1, -1});
  }
  const auto read = [&](const std::string& group) { return open_events(folder.file("numbers.h5"), {.topic = group}); };
  const auto doubles = read("a");
  CHECK(read_all(*doubles) == std::vector<Event>{{-1, 1, 1, false}, {1'000'000'000'000'000, 65535, 65535, true}});
  CHECK(testing::fault_counts(*doubles) == std::vector<std::int64_t>{5});
  CHECK(doubles->faults().all().begin()->second.first == "row 1");
  CHECK(read_all(*read("b")) == std::vector<Event>{{0, 1, 1, false}});
  CHECK(read_all(*read("c")) == std::vector<Event>{{-7, 1, 4, true}, {1'000'000'000'000'000'000, 3, 6, false}});
}

TEST_CASE("Columns of different length are a counted fault, and what they share is read") {
  const testing::TemporaryFolder folder;
  {
    Writer file(folder.file("events.h5"));
    file.add("x", std::vector<std::uint16_t>{1, 2, 3});
    file.add("y", std::vector<std::uint16_t>{1, 2, 3});
    file.add("t", std::vector<std::int64_t>{10, 20});
    file.add("p", std::vector<std::int8_t>{1, -1, 1});
  }
  const auto reader = open_events(folder.file("events.h5"));
  const auto events = read_all(*reader);
  REQUIRE(events.size() == 2);
  CHECK_FALSE(events[1].on);
  CHECK(reader->faults().all().at("columns of different length").count == 1);
  CHECK_THROWS_AS(open_events(folder.file("events.h5"), {.strict = true}), InputError);
}
