#include "core/events/aedat4/aedat4.hpp"

#include <cstring>

#include "core/events/testing/recordings.hpp"

using namespace evbench;

namespace {

const char* const kSample = "formats/aestream/davis.aedat4";

template <class T>
std::string bytes(T value) {
  std::string text(sizeof(T), '\0');
  std::memcpy(text.data(), &value, sizeof(T));
  return text;
}

/// A header without compression, and then whatever.
std::string file(const std::string& streams, const std::string& packets) {
  // Root, identifier, fields (compression 0, no table, text at 8), table, text.
  const std::string buffer = bytes<std::uint32_t>(20) + "IOHE" + bytes<std::uint16_t>(10) + bytes<std::uint16_t>(8) +
                             bytes<std::uint16_t>(0) + bytes<std::uint16_t>(0) + bytes<std::uint16_t>(4) +
                             std::string(2, '\0') + bytes<std::int32_t>(12) + bytes<std::uint32_t>(4) +
                             bytes(static_cast<std::uint32_t>(streams.size())) + streams;
  return "#!AER-DAT4.0\r\n" + bytes(static_cast<std::uint32_t>(buffer.size())) + buffer + packets;
}

/// A packet of one event.
std::string packet(std::int32_t stream, std::int64_t t, std::uint32_t length = 1) {
  const std::string buffer = bytes<std::uint32_t>(16) + "EVTS" + bytes<std::uint16_t>(6) + bytes<std::uint16_t>(8) +
                             bytes<std::uint16_t>(4) + std::string(2, '\0') + bytes<std::int32_t>(8) +
                             bytes<std::uint32_t>(4) + bytes(length) + bytes(t) + bytes<std::int16_t>(3) +
                             bytes<std::int16_t>(4) + std::string("\1\0\0\0", 4);
  const auto size = static_cast<std::uint32_t>(buffer.size());
  return bytes(stream) + bytes(size + 4) + bytes(size) + buffer;
}

std::string streams(const std::string& type) {
  return R"(<dv version="2.0"><node name="outInfo"><node name="5" path="/"><attr key="typeIdentifier" type="string">)" +
         type +
         R"(</attr><node name="info"><attr key="sizeX" type="int">346</attr><attr key="sizeY" type="int">260</attr></node></node></node></dv>)";
}

}  // namespace

TEST_CASE("AEDAT 4: the real DAVIS346 recording has the events that its table says, and its other streams are listed") {
  const auto path = testing::data_file(kSample);
  if (!path) return;
  const auto reader = open_events(*path);
  CHECK(reader->info().width == 346);
  CHECK(reader->info().height == 260);
  REQUIRE(reader->info().topics.size() == 4);
  CHECK(reader->info().topics[2] == "2 imu (IMUS), 130 elements in 13 packets");
  const auto events = testing::read_all(*reader);
  CHECK(static_cast<std::int64_t>(events.size()) == reader->info().count);
  CHECK(events.size() == 117'667);
  CHECK(events.front().t == reader->info().start);
  CHECK(events.back().t == reader->info().end);
  CHECK(std::is_sorted(events.begin(), events.end(), [](const Event& a, const Event& b) { return a.t < b.t; }));
  CHECK(std::all_of(events.begin(), events.end(), [](const Event& e) { return e.x < 346 && e.y < 260; }));
  CHECK(reader->faults().empty());
  testing::check_seeking(*path);
}

TEST_CASE("AEDAT 4: cut short or broken anywhere, it is refused or read as far as it goes", "[slow]") {
  const auto path = testing::data_file(kSample);
  if (!path) return;
  const testing::TemporaryFolder folder;
  testing::check_truncation(folder, *path, 60);
  testing::check_corruption(folder, *path, 200, 4000);
}

TEST_CASE("AEDAT 4: files without compression and without a table are read, bad packets are passed over and counted") {
  const testing::TemporaryFolder folder;
  const std::string whole =
      packet(5, 100) + packet(6, 105) + packet(5, 110) + packet(5, 120, 1u << 30) + packet(5, 130);
  const auto reader = open_events(folder.write("a", file(streams("EVTS"), whole)));
  CHECK(reader->info().width == 346);
  CHECK_FALSE(reader->info().count);
  const auto events = testing::read_all(*reader);
  REQUIRE(events.size() == 3);
  CHECK(events[1] == Event{110, 3, 4, true});
  CHECK(reader->faults().all().at("packets of unknown streams").count == 1);
  CHECK(reader->faults().all().at("broken packets of events").count == 1);

  const std::string huge = packet(5, 100) + bytes<std::int32_t>(5) + bytes<std::uint32_t>(0xFFFF'FFF0);
  const auto cut = open_events(folder.write("b", file(streams("EVTS"), huge)));
  CHECK(testing::read_all(*cut).size() == 1);
  CHECK(cut->faults().all().size() == 1);
}

TEST_CASE("AEDAT 4: without a stream of events, or of another version, it is refused and says what is there") {
  const testing::TemporaryFolder folder;
  CHECK_THROWS_WITH(open_events(folder.write("a", file(streams("FRME"), ""))),
                    Catch::Matchers::ContainsSubstring("5 FRME (FRME)"));
  CHECK_THROWS_WITH(open_events(folder.write("b", "#!AER-DAT3.1\r\nwhatever")),
                    Catch::Matchers::ContainsSubstring("another version"));
  CHECK_THROWS_WITH(open_events(folder.write("c", "#!AER-DAT4.0\r\n\xFF\xFF\xFF\xFF")),
                    Catch::Matchers::ContainsSubstring("4294967295"));
}
