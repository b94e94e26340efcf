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

}  // namespace

RosBag::RosBag(std::unique_ptr<ByteSource> file, Faults& faults) : file_(std::move(file)), faults_(faults) {
  BagRecord bag;
  end_ = file_->size();
  std::byte magic[kBegin];
  if (file_->read(0, magic) != kBegin || std::string_view(reinterpret_cast<const char*>(magic), kBegin) != kBagMagic) {
    throw InputError(
        fmt::format("{}: is a bag of another version; expected version 2.0 (`rosbag fix`)", file_->name()));
  }
  if (!read_record(kBegin, bag) || bag.op() != kBag) {
    throw InputError(fmt::format("{}: byte {}: has no bag header; expected one", file_->name(), kBegin));
  }
  if (const std::string encryptor = bag.text("encryptor"); !encryptor.empty()) {
    throw InputError(fmt::format("{}: is encrypted by {}; expected a bag that is not", file_->name(), encryptor));
  }
  const auto index = bag.number<std::uint64_t>("index_pos");
  if (index == 0 || !read_index(index, bag.number<std::uint32_t>("chunk_count"))) {
    faults_.add("no index: the bag was not closed, or is cut short", fmt::format("byte {}", index));
    topics_.clear();
    chunks_.clear();
    scan();
  } else {
    end_ = index;
  }
  std::sort(topics_.begin(), topics_.end(), [](const Topic& a, const Topic& b) { return a.id < b.id; });
}

/// False when it isn't whole.
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

/// Connections and chunks, as listed at the end of the bag.
bool RosBag::read_index(std::uint64_t offset, std::uint32_t chunks) {
  BagRecord record;
  while (offset < file_->size()) {
    if (!read_record(offset, record) || !read_data(record, packed_)) return false;
    if (record.op() == kConnection) add_topic(record, packed_);
    if (record.op() == kChunkInfo) {
      const auto seconds = record.number<std::uint64_t>("end_time");
      chunks_.push_back({record.number<std::uint64_t>("chunk_pos"),
                         static_cast<std::int64_t>((seconds & 0xFFFF'FFFF) * 1'000'000'000 + (seconds >> 32))});
      ByteCursor counts(packed_);
      while (counts.left() >= 8) {
        const auto connection = counts.get<std::uint32_t>();
        count(connection, counts.get<std::uint32_t>());
      }
    }
    offset = record.data + record.size;
  }
  return chunks_.size() == chunks;
}

/// Reads all chunks for what an index would say.
void RosBag::scan() {
  go_to(kBegin);
  BagRecord record;
  while (next_chunk()) {
    while (used_ < chunk_.size()) {
      ByteCursor cursor(std::span<const std::byte>(chunk_).subspan(used_));
      const auto header = cursor.bytes(cursor.get<std::uint32_t>());
      const auto data = cursor.bytes(cursor.get<std::uint32_t>());
      if (!cursor.ok() || !parse_fields(header, record)) break;
      used_ += cursor.at();
      if (record.op() == kConnection) add_topic(record, data);
      if (record.op() == kMessage) count(record.number<std::uint32_t>("conn"), 1);
    }
    used_ = chunk_.size();
  }
}

void RosBag::add_topic(const BagRecord& record, std::span<const std::byte> data) {
  const auto id = record.number<std::uint32_t>("conn");
  BagRecord connection;
  if (!parse_fields(data, connection)) return;
  Topic topic{id, record.text("topic"), plain_type(connection.text("type")), {}, Wire::ros1, true};
  for (Topic& known : topics_) {
    if (known.id != id) continue;
    topic.count = known.count;
    known = topic;
    return;
  }
  topics_.push_back(topic);
}

void RosBag::count(std::uint32_t connection, std::uint64_t messages) {
  for (Topic& topic : topics_) {
    if (topic.id == connection) topic.count = topic.count.value_or(0) + messages;
  }
}

/// Makes the next chunk the current one. False at the end.
bool RosBag::next_chunk() {
  BagRecord record;
  while (at_ < end_) {
    check_interruption();
    if (!read_record(at_, record)) {
      faults_.add("broken or cut records, where reading ends", place());
      at_ = end_;
      return false;
    }
    const bool loaded = record.op() == kChunk && load_chunk(record);
    at_ = record.data + record.size;
    if (loaded) return true;
  }
  return false;
}

bool RosBag::load_chunk(const BagRecord& record) {
  const std::string compression = record.text("compression");
  const auto size = record.number<std::uint32_t>("size");
  used_ = 0;
  bool whole = false;
  if (compression == "none") {
    whole = read_data(record, chunk_);
  } else if (size <= kMostBagChunk && read_data(record, packed_)) {
    if (compression == "lz4") whole = decompress_lz4(packed_, size, chunk_) && chunk_.size() == size;
    if (compression == "bz2") whole = decompress_bzip2(packed_, size, chunk_) && chunk_.size() == size;
  }
  if (!whole) {
    chunk_.clear();
    faults_.add("broken chunks", place());
  }
  return whole;
}

std::optional<Message> RosBag::next() {
  do {
    if (const auto message = next_in_chunk()) return message;
  } while (next_chunk());
  return std::nullopt;
}

std::optional<Message> RosBag::next_in_chunk() {
  BagRecord record;
  while (used_ < chunk_.size()) {
    ByteCursor cursor(std::span<const std::byte>(chunk_).subspan(used_));
    const auto header = cursor.bytes(cursor.get<std::uint32_t>());
    const auto data = cursor.bytes(cursor.get<std::uint32_t>());
    if (!cursor.ok() || !parse_fields(header, record)) {
      faults_.add("chunks with broken records", place());
      used_ = chunk_.size();
      return std::nullopt;
    }
    used_ += cursor.at();
    const auto connection = record.number<std::uint32_t>("conn");
    if (record.op() == kMessage && selected_.contains(connection)) return Message{connection, data};
  }
  return std::nullopt;
}

void RosBag::seek(std::int64_t t) {
  std::uint64_t first = end_;
  for (const ChunkInfo& chunk : chunks_) {
    if (chunk.end >= t) first = std::min(first, chunk.offset);
  }
  go_to(chunks_.empty() ? kBegin : first);
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
