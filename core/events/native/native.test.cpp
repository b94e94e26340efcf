#include "core/events/native/native.hpp"

#include <cstring>
#include <filesystem>

#include "core/events/formats.hpp"
#include "core/events/native/keeping_reader.hpp"
#include "core/support/error.hpp"
#include "core/testing/catch2.hpp"
#include "core/testing/data.hpp"
#include "core/testing/point_scene.hpp"

using namespace evbench;
using Catch::Matchers::ContainsSubstring;

namespace {

std::vector<Event> random_events(std::size_t count, int width, int height, double mean_gap) {
  Random random(7);
  std::vector<Event> events;
  std::int64_t t = -500;
  for (std::size_t i = 0; i < count; ++i) {
    t += static_cast<std::int64_t>(random.uniform(0.0, 2.0 * mean_gap));
    events.push_back({t, static_cast<std::uint16_t>(random.uniform(0, width)),
                      static_cast<std::uint16_t>(random.uniform(0, height)), random.uniform(0, 1) < 0.5});
  }
  return events;
}

std::string write_native(const std::string& path, const std::vector<Event>& events, const RecordingHeader& header) {
  NativeWriter writer(path, header);
  const std::size_t half = events.size() / 2;
  writer.write(std::span(events).first(half));
  writer.write(std::span(events).subspan(half));
  writer.finish();
  return path;
}

std::vector<Event> read_all(EventReader& reader) {
  std::vector<Event> all;
  for (std::vector<Event> events; reader.read(events);) {
    CHECK_FALSE(events.empty());
    all.insert(all.end(), events.begin(), events.end());
  }
  return all;
}

std::vector<Event> read_bytes(const std::string& bytes, const ReadOptions& options = {}) {
  NativeReader reader(std::as_bytes(std::span(bytes)), "bytes", options);
  return read_all(reader);
}

RecordingHeader davis_header() {
  RecordingHeader header;
  header.width = 240;
  header.height = 180;
  return header;
}

}  // namespace

TEST_CASE("The native format gives back the events that were written, of any sensor and any rate") {
  const testing::TemporaryFolder folder;
  struct Case {
    int width, height;
    double mean_gap;
    double bytes;  // an event, at most
  };
  const auto c = GENERATE(Case{240, 180, 1.0, 4.2}, Case{240, 180, 5000.0, 8.1}, Case{1280, 720, 0.1, 4.2},
                          Case{1280, 720, 5e7, 8.1}, Case{1, 1, 1.0, 4.2}, Case{65536, 65536, 1.0, 8.1});
  const auto events = random_events(100000, c.width, c.height, c.mean_gap);
  RecordingHeader header;
  header.width = c.width;
  header.height = c.height;
  const std::string path = write_native(folder.file("events.evb"), events, header);
  const auto reader = open_events(path);
  CHECK(reader->info().format == "evbench native 1");
  CHECK(reader->info().width == c.width);
  CHECK(reader->info().count == 100000);
  CHECK(reader->info().start == events.front().t);
  CHECK(reader->info().end == events.back().t);
  CHECK(read_all(*reader) == events);
  CHECK(reader->faults().empty());
  if (c.mean_gap < 1e6) CHECK(static_cast<double>(std::filesystem::file_size(path)) < c.bytes * 100000 + 1000);
}

TEST_CASE("The native format holds no events, and those of an unknown sensor") {
  const testing::TemporaryFolder folder;
  CHECK(read_bytes(testing::read_file(write_native(folder.file("none.evb"), {}, {}))).empty());
  const std::vector<Event> two{{-5, 65535, 0, true}, {std::int64_t{1} << 50, 0, 65535, false}};
  CHECK(read_bytes(testing::read_file(write_native(folder.file("two.evb"), two, {}))) == two);
}

TEST_CASE("The native format keeps fields, calibration and ground truth") {
  const testing::TemporaryFolder folder;
  RecordingHeader header = davis_header();
  header.metadata = {{"converted from", "a.raw"}, {"serial", "\"7\""}};
  header.calibration = Camera{{199.5, 198.5, 120, 90}, DistortionModel::radial_tangential, {}, 240, 180};
  header.calibration->coefficients << -0.3, 0.1, 1e-3, 2e-3, 0.0;
  header.ground_truth = PoseTrajectory({{0.25, {Eigen::Quaterniond(0.8, 0.6, 0, 0), Vector3(1, 2, 0.1)}}});
  NativeReader reader(write_native(folder.file("events.evb"), {}, header));
  CHECK(reader.info().metadata == header.metadata);
  REQUIRE(reader.calibration());
  CHECK(reader.calibration()->pinhole.fy == 198.5);
  CHECK(reader.calibration()->coefficients == header.calibration->coefficients);
  CHECK(reader.calibration()->width == 240);
  REQUIRE(reader.ground_truth());
  CHECK(reader.ground_truth()->poses()[0].t == 0.25);
  CHECK(reader.ground_truth()->poses()[0].T.p == Vector3(1, 2, 0.1));
  CHECK(reader.ground_truth()->poses()[0].T.q.coeffs() == header.ground_truth.poses()[0].T.q.coeffs());
}

TEST_CASE("Seeking in a native file goes to the chunk of the time, back and forth") {
  const testing::TemporaryFolder folder;
  const auto events = random_events(100000, 240, 180, 10.0);
  NativeReader reader(write_native(folder.file("events.evb"), events, davis_header()));
  std::vector<Event> chunk;
  for (const std::size_t wanted : {70000u, 3u, 99999u, 16384u}) {
    const std::int64_t t = events[wanted].t;
    reader.seek(t);
    REQUIRE(reader.read(chunk));
    CHECK(chunk.front().t <= t);
    CHECK(chunk.back().t >= t);
  }
  reader.seek(events.back().t + 1);
  CHECK_FALSE(reader.read(chunk));
  CHECK(chunk.empty());
}

TEST_CASE("A native file that is truncated anywhere is refused") {
  const testing::TemporaryFolder folder;
  const auto events = random_events(300, 240, 180, 10.0);
  const std::string bytes = testing::read_file(write_native(folder.file("events.evb"), events, davis_header()));
  for (std::size_t size = 0; size < bytes.size(); ++size)
    CHECK_THROWS_AS(read_bytes(bytes.substr(0, size)), InputError);
  CHECK_THROWS_WITH(read_bytes(bytes.substr(0, bytes.size() - 1)), ContainsSubstring("truncated?"));
  CHECK_THROWS_AS(read_bytes(bytes + "x"), InputError);
}

TEST_CASE("A native file that is shortened while it is read is an error, one that is replaced is read to its end") {
  const testing::TemporaryFolder folder;
  const auto events = random_events(100000, 240, 180, 10.0);
  const std::string path = write_native(folder.file("events.evb"), events, davis_header());
  std::vector<Event> chunk;
  {
    NativeReader reader(path);
    write_native(folder.file("other.evb"), {}, {});
    std::filesystem::rename(folder.file("other.evb"), path);
    CHECK(read_all(reader) == events);
  }
  NativeReader reader(write_native(path, events, davis_header()));
  REQUIRE(reader.read(chunk));
  std::filesystem::resize_file(path, 100000);
  CHECK_THROWS_WITH(reader.read(chunk), ContainsSubstring("events.evb: was shortened"));
}

TEST_CASE("A flipped bit anywhere in a native file is noticed") {
  const testing::TemporaryFolder folder;
  const auto events = random_events(300, 240, 180, 10.0);
  const std::string bytes = testing::read_file(write_native(folder.file("events.evb"), events, davis_header()));
  ReadOptions strict;
  strict.strict = true;
  for (std::size_t bit = 0; bit < 8 * bytes.size(); bit += 3) {
    std::string damaged = bytes;
    damaged[bit / 8] = static_cast<char>(damaged[bit / 8] ^ (1 << bit % 8));
    INFO("bit " << bit);
    CHECK_THROWS_AS(read_bytes(damaged, strict), InputError);
  }
}

TEST_CASE("A damaged chunk of a native file is left out and counted, the others are read") {
  const testing::TemporaryFolder folder;
  const auto events = random_events(3 * native::kChunkEvents, 240, 180, 10.0);
  std::string bytes = testing::read_file(write_native(folder.file("events.evb"), events, davis_header()));
  bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 1);
  NativeReader reader(std::as_bytes(std::span(bytes)), "bytes");
  const auto read = read_all(reader);
  CHECK(read.size() == 2 * native::kChunkEvents);
  CHECK(read.front() == events.front());
  CHECK(read.back() == events.back());
  REQUIRE(reader.faults().all().size() == 1);
  const auto& [kind, fault] = *reader.faults().all().begin();
  CHECK_THAT(kind, ContainsSubstring("checksum"));
  CHECK_THAT(fault.first, ContainsSubstring("chunk 1 at byte "));
  CHECK(fault.count == native::kChunkEvents);
  reader.seek(0);
  CHECK(reader.faults().empty());
  CHECK(read_all(reader) == read);
  CHECK(reader.faults().all().begin()->second.count == native::kChunkEvents);
}

TEST_CASE("A native file whose header lies, with checksums that agree, is refused") {
  const testing::TemporaryFolder folder;
  const auto events = random_events(300, 240, 180, 10.0);
  const std::string bytes = testing::read_file(write_native(folder.file("events.evb"), events, davis_header()));
  const auto with_header = [&](auto change) {
    native::Header header;
    std::string changed = bytes;
    std::memcpy(&header, changed.data(), sizeof header);
    change(header);
    header.hash = native::hash(std::as_bytes(std::span(&header, 1)).first(offsetof(native::Header, hash)));
    std::memcpy(changed.data(), &header, sizeof header);
    return changed;
  };
  CHECK_THROWS_WITH(read_bytes(with_header([](auto& h) { h.version = 9; })), ContainsSubstring("version 9"));
  CHECK_THROWS_AS(read_bytes(with_header([](auto& h) { h.chunks = 0xffffffff; })), InputError);
  CHECK_THROWS_AS(read_bytes(with_header([](auto& h) { h.index_offset = ~0ull; })), InputError);
  CHECK_THROWS_AS(read_bytes(with_header([](auto& h) { h.metadata_size = ~0ull; })), InputError);
  CHECK_THROWS_AS(read_bytes(with_header([](auto& h) { ++h.events; })), InputError);
  CHECK_THROWS_WITH(read_bytes(with_header([](auto& h) { h.width = 1 << 20; })), ContainsSubstring("sensor"));
}

TEST_CASE("What is no event of the header's sensor, in order, is not written") {
  const testing::TemporaryFolder folder;
  NativeWriter writer(folder.file("events.evb"), davis_header());
  writer.write(std::vector<Event>{{10, 1, 1, true}});
  CHECK_THROWS_WITH(writer.write(std::vector<Event>{{9, 1, 1, true}}), ContainsSubstring("time order"));
  CHECK_THROWS_WITH(writer.write(std::vector<Event>{{11, 240, 1, true}}), ContainsSubstring("outside the sensor"));
  CHECK_THROWS_AS(writer.write(std::vector<Event>{{std::int64_t{1} << 62, 1, 1, true}}), InputError);
  CHECK_THROWS_AS(NativeWriter(folder.file("no/events.evb"), {}), InputError);
}

TEST_CASE("A native file that its writer did not finish is refused") {
  const testing::TemporaryFolder folder;
  {
    NativeWriter writer(folder.file("events.evb"), davis_header());
    writer.write(random_events(50000, 240, 180, 10.0));
  }
  CHECK_THROWS_AS(NativeReader(folder.file("events.evb")), InputError);
}

TEST_CASE("A keeping reader's file has all events once they were read to the end, and is not there before") {
  const testing::TemporaryFolder folder;
  const auto events = random_events(70'000, 240, 180, 3.0);
  const std::string from = write_native(folder.file("from.evb"), events, davis_header()), to = folder.file("to.evb");
  int made = 0;
  const auto make = [&]() -> std::unique_ptr<EventReader> {
    ++made;
    return std::make_unique<NativeReader>(from);
  };
  {
    const auto partly = read_or_keep(to, make);
    std::vector<Event> first;
    CHECK(partly->read(first));
  }
  CHECK_FALSE(std::filesystem::exists(to));
  CHECK(read_all(*read_or_keep(to, make)) == events);
  CHECK(std::filesystem::exists(to));
  CHECK(made == 2);
  CHECK(read_all(*read_or_keep(to, make)) == events);
  CHECK(made == 2);  // from the file
}

TEST_CASE("What a keeping reader skips or repeats does not spoil its file") {
  const testing::TemporaryFolder folder;
  const auto events = random_events(70'000, 240, 180, 3.0);
  const std::string from = write_native(folder.file("from.evb"), events, davis_header());
  KeepingReader skipping(std::make_unique<NativeReader>(from), folder.file("skipping.evb"));
  skipping.seek(events[50'000].t);
  read_all(skipping);
  CHECK_FALSE(std::filesystem::exists(folder.file("skipping.evb")));
  KeepingReader again(std::make_unique<NativeReader>(from), folder.file("again.evb"));
  std::vector<Event> first;
  again.read(first);
  again.seek(-1'000'000);
  CHECK(read_all(again) == events);
  CHECK(read_all(*std::make_unique<NativeReader>(folder.file("again.evb"))) == events);
}
