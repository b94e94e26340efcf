#include "core/events/ros/mcap.hpp"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <map>

#include "core/events/bytes/byte_cursor.hpp"
#include "core/events/bytes/decompress.hpp"
#include "core/support/error.hpp"
#include "core/support/interruption.hpp"

namespace evbench {
namespace {

constexpr std::size_t kMagicSize = 8, kRecordHeader = 9, kFooter = kRecordHeader + 20 + kMagicSize;
constexpr std::uint64_t kMostMcapBytes = 256u << 20;  ///< of a record, and of a decompressed chunk

std::string field_text(ByteCursor& cursor) { return cursor.text(cursor.get<std::uint32_t>()); }

}  // namespace

McapBag::McapBag(std::unique_ptr<ByteSource> file, Faults& faults) : file_(std::move(file)), faults_(faults) {
  std::byte head[kMagicSize];
  if (file_->read(0, head) != kMagicSize || !is_mcap(head)) {
    throw InputError(fmt::format("{}: is no MCAP file of version 0; expected its magic bytes", file_->name()));
  }
  if (!read_summary()) {
    faults_.add("no summary: the recording was not closed, or is cut short", fmt::format("byte {}", file_->size()));
    channels_.clear();
    schemas_.clear();
    chunks_.clear();
    counts_.clear();
    scan();
  }
  for (const auto& [id, channel] : channels_) {
    const auto count = counts_.find(id);
    const bool cdr = channel.encoding == "cdr", ros1 = channel.encoding == "ros1";
    topics_.push_back({id, channel.topic, ros::plain_type(schemas_[channel.schema]),
                       count == counts_.end() ? 0 : count->second, ros1 ? ros::Wire::ros1 : ros::Wire::cdr,
                       cdr || ros1});
  }
}

/// The record at an offset, with its data if it is not too large. False when it isn't whole.
bool McapBag::read_record(std::uint64_t offset, Record& record) {
  std::byte header[kRecordHeader];
  if (file_->read(offset, header) != kRecordHeader) return false;
  record.op = static_cast<Op>(header[0]);
  const auto size = load<std::uint64_t>(header + 1);
  if (size > file_->size() - offset - kRecordHeader) return false;
  record.end = offset + kRecordHeader + size;
  record.data = {};
  if (size > kMostMcapBytes) return true;
  data_.resize(static_cast<std::size_t>(size));
  record.data = data_;
  return file_->read(offset + kRecordHeader, data_) == size;
}

/// What the end of the file says of topics, counts and chunks.
bool McapBag::read_summary() {
  std::byte footer[kFooter];
  if (file_->size() < kMagicSize + kFooter) return false;
  const std::uint64_t end = file_->size() - kFooter;
  if (file_->read(end, footer) != kFooter || !is_mcap(std::span(footer).last(kMagicSize)) ||
      static_cast<Op>(footer[0]) != Op::footer) {
    return false;
  }
  std::uint64_t at = load<std::uint64_t>(footer + kRecordHeader);
  if (at == 0 || at > end) return false;
  end_ = at;
  bool counted = false;
  for (Record record; at < end; at = record.end) {
    if (!read_record(at, record)) return false;
    counted = counted || record.op == Op::statistics;
    if (!note(record.op, record.data)) return false;
  }
  return counted && at == end && !channels_.empty();
}

/// Reads all for what a summary would say.
void McapBag::scan() {
  end_ = file_->size();
  go_to(kMagicSize);
  while (const auto message = next_of_all()) ++counts_[static_cast<std::uint16_t>(message->topic)];
}

/// Takes what a record says of the file. False when it is broken.
bool McapBag::note(Op op, std::span<const std::byte> data) {
  ByteCursor cursor(data);
  switch (op) {
    case Op::schema: {
      const auto id = cursor.get<std::uint16_t>();
      schemas_[id] = field_text(cursor);
      break;
    }
    case Op::channel: {
      const auto id = cursor.get<std::uint16_t>();
      Channel channel;
      channel.schema = cursor.get<std::uint16_t>();
      channel.topic = field_text(cursor);
      channel.encoding = field_text(cursor);
      if (cursor.ok()) channels_[id] = channel;
      break;
    }
    case Op::chunk_index: {
      cursor.get<std::uint64_t>();
      const auto end = cursor.get<std::uint64_t>(), offset = cursor.get<std::uint64_t>();
      chunks_.push_back({offset, end});
      break;
    }
    case Op::statistics: {
      cursor.bytes(8 + 2 + 4 * 4 + 2 * 8);
      for (auto left = cursor.get<std::uint32_t>() / 10; left > 0 && cursor.ok(); --left) {
        const auto id = cursor.get<std::uint16_t>();
        counts_[id] = cursor.get<std::uint64_t>();
      }
      break;
    }
    default: break;
  }
  return cursor.ok();
}

void McapBag::go_to(std::uint64_t offset) {
  at_ = offset;
  chunk_ = {};
  used_ = 0;
}

void McapBag::select(std::set<std::uint32_t> topics) {
  selected_ = std::move(topics);
  go_to(kMagicSize);
}

std::optional<ros::Message> McapBag::next() {
  while (const auto message = next_of_all()) {
    if (selected_.contains(message->topic)) return message;
  }
  return std::nullopt;
}

/// The next message of whatever topic, in a chunk or between them.
std::optional<ros::Message> McapBag::next_of_all() {
  while (true) {
    check_interruption();
    while (used_ < chunk_.size()) {
      ByteCursor cursor(chunk_.subspan(used_));
      const auto op = static_cast<Op>(cursor.get<std::uint8_t>());
      const auto data = cursor.bytes(cursor.get<std::uint64_t>());
      if (!cursor.ok()) {
        faults_.add("chunks with broken records", place());
        used_ = chunk_.size();
        break;
      }
      used_ += cursor.at();
      if (const auto message = take(op, data)) return message;
    }
    Record record;
    if (at_ >= end_) return std::nullopt;
    if (!read_record(at_, record)) {
      faults_.add("broken or cut records, where reading ends", place());
      at_ = end_;
      return std::nullopt;
    }
    if (record.op == Op::chunk && !load_chunk(record.data)) faults_.add("broken chunks", place());
    at_ = record.op == Op::data_end ? end_ : record.end;
    if (const auto message = take(record.op, record.data)) return message;
  }
}

/// The message, if the record is one.
std::optional<ros::Message> McapBag::take(Op op, std::span<const std::byte> data) {
  constexpr std::size_t kHeader = 2 + 4 + 8 + 8;  // channel, sequence number, times of recording and publishing
  if (op == Op::message && data.size() >= kHeader) {
    return ros::Message{load<std::uint16_t>(data.data()), data.subspan(kHeader)};
  }
  if ((op == Op::schema || op == Op::channel) && !note(op, data)) faults_.add("broken records", place());
  return std::nullopt;
}

bool McapBag::load_chunk(std::span<const std::byte> data) {
  ByteCursor cursor(data);
  cursor.bytes(2 * 8);  // first and last time
  const auto size = cursor.get<std::uint64_t>();
  const auto checksum = cursor.get<std::uint32_t>();
  const std::string compression = field_text(cursor);
  const auto packed = cursor.bytes(cursor.get<std::uint64_t>());
  used_ = 0;
  chunk_ = {};
  if (!cursor.ok() || size > kMostMcapBytes) return false;
  std::span<const std::byte> records = packed;
  if (!compression.empty()) {
    const bool unpacked = compression == "lz4"    ? decompress_lz4(packed, size, unpacked_)
                          : compression == "zstd" ? decompress_zstd(packed, size, unpacked_)
                                                  : false;
    if (!unpacked) return false;
    records = unpacked_;
  }
  if (records.size() != size) return false;
  if (checksum != 0 && checksum != crc32_z(0, reinterpret_cast<const Bytef*>(records.data()), records.size())) {
    return false;
  }
  chunk_ = records;
  return true;
}

void McapBag::seek(std::int64_t t) {
  std::uint64_t first = end_;
  for (const ChunkInfo& chunk : chunks_) {
    if (chunk.end >= static_cast<std::uint64_t>(std::max<std::int64_t>(t, 0))) first = std::min(first, chunk.offset);
  }
  go_to(chunks_.empty() ? kMagicSize : first);
}

bool McapBag::is_mcap(std::span<const std::byte> head) {
  constexpr unsigned char kMagic[kMagicSize] = {0x89, 'M', 'C', 'A', 'P', '0', '\r', '\n'};
  return head.size() >= kMagicSize && std::equal(std::begin(kMagic), std::end(kMagic), head.begin(),
                                                 [](unsigned char a, std::byte b) { return std::byte{a} == b; });
}

EventFormat mcap_format() {
  return {"mcap", "MCAP (ROS 2 or 1) with event_camera_msgs",
          [](const std::string&, std::span<const std::byte> head) { return McapBag::is_mcap(head); },
          [](const std::string& path, const ReadOptions& options) {
            return ros::read_bag(path, "MCAP", options, [path](Faults& faults) {
              return std::make_unique<McapBag>(std::make_unique<FileBytes>(path), faults);
            });
          }};
}

}  // namespace evbench
