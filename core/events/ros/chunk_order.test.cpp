#include "core/events/ros/chunk_order.hpp"

#include "core/support/error.hpp"
#include "core/support/index.hpp"
#include "core/testing/catch2.hpp"

using namespace evbench;
using ros::Chunk, ros::ChunkOrder, ros::LoadedChunk;

namespace {

using Times = std::vector<std::int64_t>;

/// Chunks of some messages' times, at offsets 100, 200, ..., of 1000 bytes each.
class TimedChunks {
 public:
  explicit TimedChunks(std::vector<Times> contents) : contents_(std::move(contents)) {
    for (std::size_t i = 0; i < contents_.size(); ++i) {
      Chunk chunk{100 * (i + 1), 50};
      for (const std::int64_t t : contents_[i]) chunk.add_time(t);
      chunks.push_back(chunk);
    }
  }

  void load(const Chunk& chunk, LoadedChunk& content) {
    ++loads;
    content.bytes.resize(1000);
    const std::size_t which = chunk.offset / 100 - 1;
    const Times& times = contents_[which];
    for (std::size_t i = 0; i < times.size(); ++i) {
      const auto id = static_cast<std::uint32_t>(100 * which + i);
      content.messages.push_back({times[i], {id, ros::Wire::ros1, content.bytes}});
    }
  }

  std::int64_t time_of(std::uint32_t id) const { return contents_[id / 100][id % 100]; }

  /// Of all messages, as they come; their ids: 100 times the chunk's number, and their places in it.
  std::vector<std::uint32_t> read(ChunkOrder& order, std::int64_t from = std::numeric_limits<std::int64_t>::min()) {
    std::vector<std::uint32_t> ids;
    order.begin(chunks, from);
    while (const auto message = order.next()) ids.push_back(message->connection);
    return ids;
  }

  std::vector<Chunk> chunks;
  int loads = 0;

 private:
  std::vector<Times> contents_;
};

}  // namespace

TEST_CASE("Chunks in any order in the file, which overlap and are in disorder within, give messages in order of time") {
  TimedChunks chunks({{50, 60, 55}, {10, 20, 30}, {70, 25, 5}, {60}});
  Faults faults("test", false);
  const std::size_t most = GENERATE(std::size_t{0}, std::size_t{2500}, ChunkOrder::kMostBytes);
  ChunkOrder order([&](const Chunk& chunk, LoadedChunk& content) { chunks.load(chunk, content); }, faults, most);
  const std::vector<std::uint32_t> expected{202, 100, 101, 201, 102, 0, 2, 1, 300, 200};
  for (int round = 0; round < 2; ++round) CHECK(chunks.read(order) == expected);
  CHECK(chunks.read(order, 26) == std::vector<std::uint32_t>(expected.begin() + 4, expected.end()));
  CHECK(chunks.read(order, 60) == std::vector<std::uint32_t>{1, 300, 200});
  CHECK(chunks.read(order, 71).empty());
  CHECK(faults.empty());
}

TEST_CASE("Of many overlapping chunks as many are kept as there is room for, and others are loaded again") {
  constexpr int kChunks = 20, kMessages = 10;
  std::vector<Times> contents(kChunks);
  for (int i = 0; i < kChunks; ++i) {
    contents[index(i)].push_back(0);  // all begin at the same time
    for (int k = 1; k < kMessages; ++k) contents[index(i)].push_back(100 * i + k);
  }
  TimedChunks chunks(contents);
  Faults faults("test", false);
  ChunkOrder order([&](const Chunk& chunk, LoadedChunk& content) { chunks.load(chunk, content); }, faults, 5000);
  const auto ids = chunks.read(order);
  REQUIRE(ids.size() == kChunks * kMessages);
  CHECK(std::ranges::is_sorted(ids, {}, [&](std::uint32_t id) { return chunks.time_of(id); }));
  CHECK(chunks.loads <= 3 * kChunks);
}

TEST_CASE("Chunks that do not overlap are loaded once each") {
  TimedChunks chunks({{1, 2}, {3, 4}, {5, 6}});
  Faults faults("test", false);
  ChunkOrder order([&](const Chunk& chunk, LoadedChunk& content) { chunks.load(chunk, content); }, faults, 0);
  CHECK(chunks.read(order).size() == 6);
  CHECK(chunks.loads == 3);
}

TEST_CASE("Messages at other times than the index says are given, and counted as a fault once") {
  TimedChunks chunks({{10, 20}, {15, 5}});
  chunks.chunks[1].start = 15;
  Faults faults("test", false);
  ChunkOrder order([&](const Chunk& chunk, LoadedChunk& content) { chunks.load(chunk, content); }, faults, 0);
  auto ids = chunks.read(order);
  std::ranges::sort(ids);
  CHECK(ids == std::vector<std::uint32_t>{0, 1, 100, 101});
  REQUIRE(faults.all().size() == 1);
  CHECK(faults.all().begin()->second.count == 1);
  CHECK(faults.all().begin()->second.first == "byte 200");
}
