#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <queue>
#include <utility>
#include <vector>

#include "core/events/faults.hpp"
#include "core/events/ros/message_source.hpp"

namespace evbench::ros {

/// A part of a bag's file that is loaded at once, and the log times [ns] of its messages.
struct Chunk {
  std::uint64_t offset = 0, size = 0;  ///< in the file
  std::int64_t start = std::numeric_limits<std::int64_t>::max(), end = std::numeric_limits<std::int64_t>::min();

  void add_time(std::int64_t t) {
    start = std::min(start, t);
    end = std::max(end, t);
  }
};

/// A chunk's messages of the selected connections.
struct LoadedChunk {
  struct Entry {
    std::int64_t t = 0;  ///< log time [ns]
    Message message;
  };
  std::vector<std::byte> bytes;  ///< the data of the messages
  std::vector<Entry> messages;
};

/// The messages of chunks in the order of their log times; equal times in the file's order. Chunks may be in any order
/// and overlap. Overlapping chunks are kept in memory, up to `most_bytes` of them; beyond that, the chunk that is
/// needed last is dropped and loaded again later.
class ChunkOrder {
 public:
  /// Fills an empty LoadedChunk, in the file's order; broken content is left out and added to the faults.
  using Load = std::function<void(const Chunk& chunk, LoadedChunk& content)>;

  static constexpr std::size_t kMostBytes = std::size_t{512} << 20;

  /// `faults` must outlive it.
  ChunkOrder(Load load, Faults& faults, std::size_t most_bytes = kMostBytes);

  /// Restarts with the first message at or after a time [ns].
  void begin(const std::vector<Chunk>& chunks, std::int64_t from = std::numeric_limits<std::int64_t>::min());

  /// The next message; none at the end. Its data is valid until the next call.
  std::optional<Message> next();

 private:
  /// Position of a chunk's next message: its log time, and the chunk's offset.
  using Place = std::pair<std::int64_t, std::uint64_t>;
  struct Closed {
    Place place;
    Chunk chunk;
    std::size_t given = 0;  ///< messages already returned
    bool again = false;     ///< has been loaded before
    bool operator>(const Closed& other) const { return place > other.place; }
  };
  struct Open {
    Chunk chunk;
    LoadedChunk content;
    std::size_t next = 0;
    std::size_t bytes = 0;
  };

  void advance();
  void open(const Closed& closed);
  void close_last();
  void recycle(Open& chunk);

  Load load_;
  Faults& faults_;
  std::size_t most_bytes_, bytes_ = 0;
  std::int64_t from_ = 0;
  std::priority_queue<Closed, std::vector<Closed>, std::greater<>> closed_;
  std::map<Place, Open> open_;
  bool given_ = false;  ///< the next message of the first open chunk has been returned
  LoadedChunk spare_;   ///< memory of a closed one, for reuse
};

}  // namespace evbench::ros
