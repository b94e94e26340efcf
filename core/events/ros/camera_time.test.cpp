#include "core/events/event_stream.hpp"
#include "core/events/testing/bag_writer.hpp"
#include "core/events/testing/recordings.hpp"

using namespace evbench;
using namespace evbench::testing::bag_writer;

// Times of EVT 3 in bags: the camera's own 24 bits, which wrap unnoticed where packets pause.

namespace {

constexpr std::int64_t kEpoch = 1'500'000'000'000'000;  ///< [µs] of ROS at the camera's zero
constexpr std::int64_t kPacketTime = 50'000;            ///< [µs]

std::string word(unsigned type, std::int64_t value) {
  return testing::bytes(static_cast<std::uint16_t>(type << 12 | (static_cast<unsigned>(value) & 0xFFF)));
}

/// event_camera_msgs/EventPacket of two events at the camera's time t [µs], stamped with `stamp` [µs].
BagMessage camera_packet(std::int64_t t, std::int64_t stamp) {
  std::string words;
  for (const std::int64_t at : {t, t + 10}) {
    words += word(0x8, at >> 12) + word(0x6, at) + word(0x0, 20) + word(0x2, 30);
  }
  const std::int64_t ros = 1000 * (kEpoch + stamp);
  return {0, ros,
          ros_header(ros) + bytes<std::uint32_t>(720) + bytes<std::uint32_t>(1280) + bytes<std::uint64_t>(0) +
              bytes<std::uint64_t>(0) + text("evt3") + '\0' + text(words)};
}

/// A packet each 50 ms over some spans of time [s].
std::vector<BagMessage> camera_packets(const std::vector<std::pair<double, double>>& spans,
                                       std::int64_t camera_behind = 0) {
  std::vector<BagMessage> messages;
  for (const auto& [from, to] : spans) {
    for (auto t = static_cast<std::int64_t>(1e6 * from); t < static_cast<std::int64_t>(1e6 * to); t += kPacketTime) {
      messages.push_back(camera_packet(t - camera_behind, t));
    }
  }
  return messages;
}

std::string write_bag(const testing::TemporaryFolder& folder, const std::vector<BagMessage>& messages) {
  return folder.write("packets.bag", bag_of({{"/events", "event_camera_msgs/EventPacket"}}, {messages}));
}

}  // namespace

TEST_CASE("Packets that pause, also for longer than the camera's time takes to wrap, have their own times") {
  const testing::TemporaryFolder folder;
  const std::string path = write_bag(folder, camera_packets({{0, 14}, {17, 18}, {23, 24}, {50, 51}, {100, 110}}));
  const std::vector<Event> all = testing::read_all(path);
  CHECK(open_events(path)->faults().empty());
  REQUIRE(all.size() == 2 * 20 * 27);
  CHECK(all.front().t == 0);
  CHECK(all.back().t == 109'950'010);
  CHECK(std::ranges::count_if(all, [](const Event& event) { return event.t >= 50'000'000; }) == 2 * 20 * 11);
  testing::check_seeking(path);
  for (const std::int64_t from : {12'500'000, 13'900'000, 17'500'000, 30'000'000, 99'000'000}) {
    CAPTURE(from);
    EventStream stream(path, {.from = from});
    std::vector<Event> events;
    std::size_t count = 0;
    while (stream.read(events)) count += events.size();
    CHECK(count ==
          static_cast<std::size_t>(std::ranges::count_if(all, [from](const Event& event) { return event.t >= from; })));
  }
}

TEST_CASE("A camera that was restarted between packets goes on by their stamps, which is a fault") {
  const testing::TemporaryFolder folder;
  std::vector<BagMessage> messages = camera_packets({{0, 10}});
  const std::vector<BagMessage> later = camera_packets({{15, 20}}, 15'000'000);
  messages.insert(messages.end(), later.begin(), later.end());
  const auto reader = open_events(write_bag(folder, messages));
  const std::vector<Event> all = testing::read_all(*reader);
  REQUIRE(all.size() == 2 * 20 * 15);
  CHECK(all.back().t == 19'950'010);
  REQUIRE(reader->faults().all().size() == 1);
  CHECK(reader->faults().all().begin()->first.starts_with("restarts of the camera's clock"));
}
