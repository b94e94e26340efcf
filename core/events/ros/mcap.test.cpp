#include <algorithm>

#include "core/events/testing/mcap_writer.hpp"
#include "core/events/testing/recordings.hpp"

using namespace evbench;
using namespace evbench::testing::mcap_writer;

namespace {

/// A second channel of the topic.
std::string two_channels() {
  return topics() +
         record(4, bytes<std::uint16_t>(10) + bytes<std::uint16_t>(1) + text("/events") + text("ros1") + text(""));
}

/// Messages of one event each at some times [µs], by the two channels in turn.
std::string messages_at(std::initializer_list<std::uint32_t> times) {
  std::string records;
  for (const std::uint32_t t : times) {
    records += message(t % 2 == 0 ? 9 : 10, 1'000'000'000 + std::uint64_t{t} * 1000, packet(t));
  }
  return records;
}

std::string timed_chunk(const std::string& compression, std::initializer_list<std::uint32_t> times,
                        const std::string& before = "") {
  const auto at = [](std::uint32_t t) { return 1'000'000'000 + std::uint64_t{t} * 1000; };
  return chunk(compression, before + messages_at(times), at(std::min(times)), at(std::max(times)));
}

std::vector<std::int64_t> times_of(EventReader& reader) {
  std::vector<std::int64_t> times;
  for (const Event& event : testing::read_all(reader)) times.push_back(event.t - 7'000'000);
  return times;
}

}  // namespace

TEST_CASE("MCAP is read in the order of log times, of all channels of the topic, however it is packed") {
  const std::string compression = GENERATE("", "lz4", "zstd", "unchunked");
  const bool closed = GENERATE(true, false);
  CAPTURE(compression, closed);
  std::vector<std::string> parts{timed_chunk(compression, {14, 12, 17}, two_channels()),
                                 timed_chunk(compression, {10, 11}), timed_chunk(compression, {20, 15, 19})};
  if (compression == "unchunked") {
    parts = {two_channels() + messages_at({14, 12, 17}), messages_at({10, 11}), messages_at({20, 15, 19})};
  }
  const testing::TemporaryFolder folder;
  const std::string path = folder.write(
      "a.mcap", closed ? closed_mcap(parts, two_channels(), {{9, 4}, {10, 4}}) : mcap(parts[0] + parts[1] + parts[2]));
  const auto reader = open_events(path);
  CHECK(times_of(*reader) == std::vector<std::int64_t>{10, 11, 12, 14, 15, 17, 19, 20});
  CHECK(reader->info().topics == std::vector<std::string>{"/events (event_camera_msgs/EventPacket), 8 messages"});
  CHECK(reader->faults().all().size() == (closed ? 0 : 1));
  testing::check_seeking(path);
}

TEST_CASE("MCAP whose index or whose chunks' times lie is read, and that is counted") {
  const testing::TemporaryFolder folder;
  const std::vector<std::string> parts{timed_chunk("", {14, 12}), timed_chunk("", {10, 11})};
  std::string bag = closed_mcap(parts, two_channels(), {{9, 3}, {10, 1}});
  const std::string place = bytes<std::uint64_t>(mcap("").size());
  bag.replace(bag.find(place, mcap("").size() + parts[0].size() + parts[1].size()), 8, bytes<std::uint64_t>(100));
  auto reader = open_events(folder.write("a.mcap", bag));
  CHECK(times_of(*reader) == std::vector<std::int64_t>{10, 11, 12, 14});
  CHECK(reader->faults().all().contains("chunks that the index does not name"));
  CHECK(reader->faults().all().contains("chunks that are not where the index says"));

  const std::vector<std::string> wrong{chunk("lz4", messages_at({14, 12})), chunk("lz4", messages_at({10, 11}))};
  reader = open_events(folder.write("b.mcap", closed_mcap(wrong, two_channels(), {{9, 3}, {10, 1}})));
  CHECK(times_of(*reader) == std::vector<std::int64_t>{10, 11, 12, 14});
  CHECK(reader->faults().all().at("chunks with messages of other times than the index says").count == 2);
}

TEST_CASE("MCAP with a summary, broken anywhere, is never a crash") {
  const std::string bag =
      closed_mcap({timed_chunk("zstd", {10, 11, 12}, two_channels()), messages_at({13, 14}), timed_chunk("", {17, 15})},
                  two_channels(), {{9, 3}, {10, 4}});
  testing::check_survives(bag, [folder = std::make_shared<testing::TemporaryFolder>()](const std::string& content) {
    return open_events(folder->write("broken.mcap", content));
  });
}
