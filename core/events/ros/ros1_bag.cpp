#include "core/events/ros/ros1_bag.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "core/events/bytes/byte_cursor.hpp"
#include "core/events/bytes/decompress.hpp"
#include "core/support/error.hpp"
#include "core/support/interruption.hpp"

namespace evbench {
namespace {

using namespace ros;

constexpr std::string_view kBagMagic = "#ROSBAG V2.0\n";
constexpr std::uint64_t kRecords = 13;  // where they begin, behind the magic bytes
constexpr std::size_t kMostBagHeader = 1 << 20, kMostBagChunk = 256u << 20;

enum Op : unsigned { kMessage = 2, kBag = 3, kChunk = 5, kChunkInfo = 6, kConnection = 7 };

bool parse_fields(std::span<const std::byte> header, BagRecord& record) {
  record.fields.clear();
  ByteCursor cursor(header);
  while (cursor.ok() && cursor.left() > 0) {
    const auto field = cursor.bytes(cursor.get<std::uint32_t>());
    const auto equals = std::find(field.begin(), field.end(), std::byte{'='});
    if (!cursor.ok() || equals == field.end()) return false;
    const auto length = static_cast<std::size_t>(equals - field.begin());
    record.fields[std::string(reinterpret_cast<const char*>(field.data()), length)] = field.subspan(length + 1);
  }
  return cursor.ok();
}

/// Time [ns] from seconds and nanoseconds.
std::int64_t bag_time(std::uint64_t time) {
  return static_cast<std::int64_t>((time & 0xFFFF'FFFF) * 1'000'000'000 + (time >> 32));
}

/// Calls take(record, data) for the records of a chunk. Stops at a broken one and returns false.
template <class Take>
bool for_records(std::span<const std::byte> chunk, Take take) {
  BagRecord record;
  for (ByteCursor cursor(chunk); cursor.left() > 0;) {
    const auto header = cursor.bytes(cursor.get<std::uint32_t>());
    const auto data = cursor.bytes(cursor.get<std::uint32_t>());
    if (!cursor.ok() || !parse_fields(header, record)) return false;
    take(record, data);
  }
  return true;
}

}  // namespace

RosBag::RosBag(std::unique_ptr<ByteSource> file, Faults& faults)
    : file_(std::move(file)),
      faults_(faults),
      order_([this](const Chunk& chunk, LoadedChunk& content) { load_chunk(chunk, content); }, faults) {
  BagRecord bag;
  std::byte magic[kRecords];
  if (file_->read(0, magic) != kRecords ||
      std::string_view(reinterpret_cast<const char*>(magic), kRecords) != kBagMagic) {
    throw InputError(
        fmt::format("{}: is a bag of another version; expected version 2.0 (`rosbag fix`)", file_->name()));
  }
  if (!read_record(kRecords, bag) || bag.op() != kBag) {
    throw InputError(fmt::format("{}: byte {}: has no bag header; expected one", file_->name(), kRecords));
  }
  if (const std::string encryptor = bag.text("encryptor"); !encryptor.empty()) {
    throw InputError(fmt::format("{}: is encrypted by {}; expected a bag that is not", file_->name(), encryptor));
  }
  const auto offset = bag.number<std::uint64_t>("index_pos");
  Index index;
  if (offset == 0 || !read_index(offset, bag.number<std::uint32_t>("chunk_count"), index)) {
    faults_.add("no index: the bag was not closed, or is cut short", fmt::format("byte {}", offset));
    connections_.clear();
    index.clear();
    find_chunks(index, file_->size());
  } else {
    find_chunks(index, offset);
  }
  std::ranges::sort(connections_, {}, &Connection::id);
}

/// False if the record isn't whole.
bool RosBag::read_record(std::uint64_t offset, BagRecord& record) {
  std::byte length[4];
  if (file_->read(offset, length) != 4) return false;
  const std::uint64_t size = load<std::uint32_t>(length);
  if (size > kMostBagHeader || offset + 8 + size > file_->size()) return false;
  header_.resize(size + 4);
  if (file_->read(offset + 4, header_) != header_.size()) return false;
  record.size = load<std::uint32_t>(header_.data() + size);
  record.data = offset + 8 + size;
  header_.resize(size);
  return record.data + record.size <= file_->size() && parse_fields(header_, record);
}

bool RosBag::read_data(const BagRecord& record, std::vector<std::byte>& data) {
  if (record.size > kMostBagChunk) return false;
  data.resize(record.size);
  return file_->read(record.data, data) == data.size();
}

/// Reads connections and chunks from the list at the end of the bag.
bool RosBag::read_index(std::uint64_t offset, std::uint32_t chunks, Index& index) {
  BagRecord record;
  if (offset > file_->size()) return false;
  while (offset < file_->size()) {
    if (!read_record(offset, record) || !read_data(record, packed_)) return false;
    if (record.op() == kConnection) add_connection(record, packed_);
    if (record.op() == kChunkInfo) {
      const auto at = record.number<std::uint64_t>("chunk_pos");
      index[at] = {at, 0, bag_time(record.number<std::uint64_t>("start_time")),
                   bag_time(record.number<std::uint64_t>("end_time"))};
      ByteCursor counts(packed_);
      while (counts.left() >= 8) {
        const auto connection = counts.get<std::uint32_t>();
        count(connection, counts.get<std::uint32_t>());
      }
    }
    offset = record.data + record.size;
  }
  return index.size() == chunks;
}

/// After a broken record it continues with the next chunk of the index.
void RosBag::find_chunks(const Index& index, std::uint64_t end) {
  BagRecord record;
  std::size_t named = 0;
  for (std::uint64_t at = kRecords; at < end;) {
    check_interruption();
    const std::string place = fmt::format("byte {}", at);
    if (!read_record(at, record)) {
      const auto next = index.upper_bound(at);
      faults_.add(next == index.end() ? "broken or cut records, where reading ends"
                                      : "broken records, behind which reading goes on with the next chunk",
                  place);
      at = next == index.end() ? end : next->first;
      continue;
    }
    Chunk chunk{at, record.data + record.size - at};
    at = record.data + record.size;
    if (record.op() != kChunk) continue;
    if (const auto known = index.find(chunk.offset); known != index.end()) {
      ++named;
      chunk.start = known->second.start;
      chunk.end = known->second.end;
      chunks_.push_back(chunk);
    } else {
      if (!index.empty()) faults_.add("chunks that the index does not name", place);
      if (scan(chunk)) chunks_.push_back(chunk);
    }
  }
  if (named < index.size()) {
    faults_.add("chunks that are not where the index says", "the index",
                static_cast<std::int64_t>(index.size() - named));
  }
}

/// Reads a chunk for what an index would contain. False for one without messages.
bool RosBag::scan(Chunk& chunk) {
  std::vector<std::byte> content;
  if (!unpack(chunk.offset, content)) return false;
  for_records(content, [&](const BagRecord& record, std::span<const std::byte> data) {
    if (record.op() == kConnection) add_connection(record, data);
    if (record.op() != kMessage) return;
    count(record.number<std::uint32_t>("conn"), 1);
    chunk.add_time(bag_time(record.number<std::uint64_t>("time")));
  });
  return chunk.start <= chunk.end;
}

void RosBag::add_connection(const BagRecord& record, std::span<const std::byte> data) {
  BagRecord header;
  if (!parse_fields(data, header)) return;
  Connection connection{
      record.number<std::uint32_t>("conn"), record.text("topic"), plain_type(header.text("type")), {}};
  for (Connection& known : connections_) {
    if (known.id != connection.id) continue;
    connection.count = known.count;
    known = connection;
    return;
  }
  connections_.push_back(connection);
}

void RosBag::count(std::uint32_t id, std::uint64_t messages) {
  for (Connection& connection : connections_) {
    if (connection.id == id) connection.count = connection.count.value_or(0) + messages;
  }
}

/// Unpacks a chunk's record. False if it is broken: a fault.
bool RosBag::unpack(std::uint64_t offset, std::vector<std::byte>& chunk) {
  BagRecord record;
  bool whole = false;
  if (read_record(offset, record)) {
    const std::string compression = record.text("compression");
    const auto size = record.number<std::uint32_t>("size");
    if (compression == "none") {
      whole = read_data(record, chunk);
    } else if (size <= kMostBagChunk && read_data(record, packed_)) {
      if (compression == "lz4") whole = decompress_lz4(packed_, size, chunk) && chunk.size() == size;
      if (compression == "bz2") whole = decompress_bzip2(packed_, size, chunk) && chunk.size() == size;
    }
  }
  if (!whole) faults_.add("broken chunks", fmt::format("byte {}", offset));
  return whole;
}

void RosBag::load_chunk(const Chunk& chunk, LoadedChunk& content) {
  if (!unpack(chunk.offset, content.bytes)) return;
  const bool whole = for_records(content.bytes, [&](const BagRecord& record, std::span<const std::byte> data) {
    const auto connection = record.number<std::uint32_t>("conn");
    if (record.op() != kMessage || !selected_.contains(connection)) return;
    content.messages.push_back({bag_time(record.number<std::uint64_t>("time")), {connection, Wire::ros1, data}});
  });
  if (!whole) faults_.add("chunks with broken records", fmt::format("byte {}", chunk.offset));
}

EventFormat ros1_bag_format() {
  return {"ros1-bag", "ROS 1 bag with event_camera_msgs, dvs_msgs or prophesee_event_msgs",
          [](const std::string&, std::span<const std::byte> head) {
            return head.size() >= kBagMagic.size() &&
                   std::equal(kBagMagic.begin(), kBagMagic.begin() + 9, head.begin(),
                              [](char a, std::byte b) { return static_cast<std::byte>(a) == b; });
          },
          [](const std::string& path, const ReadOptions& options) {
            return read_bag(path, "ROS 1 bag", options, [path](Faults& faults) {
              return std::make_unique<RosBag>(std::make_unique<FileBytes>(path), faults);
            });
          }};
}

}  // namespace evbench
