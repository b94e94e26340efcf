#include "core/events/ros/mcap.hpp"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <limits>
#include <map>

#include "core/events/bytes/byte_cursor.hpp"
#include "core/events/bytes/decompress.hpp"
#include "core/support/error.hpp"
#include "core/support/interruption.hpp"

namespace evbench {
namespace {

constexpr std::size_t kMagicSize = 8, kRecordHeader = 9, kFooter = kRecordHeader + 20 + kMagicSize;
constexpr std::size_t kMessageHeader = 2 + 4 + 8 + 8;  // channel, sequence number, times of recording and publishing
constexpr std::uint64_t kMostMcapBytes = 256u << 20;   // of a record, and of a decompressed chunk

std::string field_text(ByteCursor& cursor) { return cursor.text(cursor.get<std::uint32_t>()); }

std::int64_t mcap_time(std::uint64_t time) {  // [ns]
  constexpr std::int64_t kLatest = std::numeric_limits<std::int64_t>::max();
  return static_cast<std::int64_t>(std::min<std::uint64_t>(time, kLatest));
}

std::int64_t log_time(std::span<const std::byte> message) {
  return mcap_time(load<std::uint64_t>(message.data() + 2 + 4));
}

/// Calls take(op, data) for consecutive records. False if one is broken: that record, or all from there on, is left
/// out.
template <class Op, class Take>
bool for_records(std::span<const std::byte> records, Op message, Take take) {
  bool whole = true;
  for (ByteCursor cursor(records); cursor.left() > 0;) {
    const auto op = static_cast<Op>(cursor.get<std::uint8_t>());
    const auto data = cursor.bytes(cursor.get<std::uint64_t>());
    if (!cursor.ok()) return false;
    if (op == message && data.size() < kMessageHeader) {
      whole = false;
    } else {
      take(op, data);
    }
  }
  return whole;
}

}  // namespace

McapBag::McapBag(std::unique_ptr<ByteSource> file, Faults& faults)
    : file_(std::move(file)),
      faults_(faults),
      order_([this](const ros::Chunk& chunk, ros::LoadedChunk& content) { load_chunk(chunk, content); }, faults) {
  std::byte head[kMagicSize];
  if (file_->read(0, head) != kMagicSize || !is_mcap(head)) {
    throw InputError(fmt::format("{}: is no MCAP file of version 0; expected its magic bytes", file_->name()));
  }
  summarised_ = read_summary();
  if (!summarised_) {
    faults_.add("no summary: the recording was not closed, or is cut short", fmt::format("byte {}", file_->size()));
    channels_.clear();
    schemas_.clear();
    index_.clear();
    counts_.clear();
    end_ = file_->size();
  }
  find_chunks();
  for (const auto& [id, channel] : channels_) {
    const bool cdr = channel.encoding == "cdr", ros1 = channel.encoding == "ros1";
    ros::Connection connection{id, channel.topic, ros::plain_type(schemas_[channel.schema]), {}, cdr || ros1};
    if (counted_) connection.count = counts_[id];
    connections_.push_back(connection);
  }
}

/// Reads the record at an offset, with its data up to `most` bytes. False if it isn't whole.
bool McapBag::read_record(std::uint64_t offset, Record& record, std::uint64_t most) {
  std::byte head[kRecordHeader + kMessageHeader];
  const std::size_t there = file_->read(offset, head);
  if (there < kRecordHeader) return false;
  record.op = static_cast<Op>(head[0]);
  const auto size = load<std::uint64_t>(head + 1);
  if (size > file_->size() - offset - kRecordHeader) return false;
  record.end = offset + kRecordHeader + size;
  data_.resize(static_cast<std::size_t>(std::min(size, most)));
  record.data = data_;
  if (data_.size() > there - kRecordHeader) return file_->read(offset + kRecordHeader, data_) == data_.size();
  std::copy_n(head + kRecordHeader, data_.size(), data_.begin());
  return true;
}

/// Reads topics, counts and chunks from the summary at the end of the file.
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
    if (!read_record(at, record, kMostMcapBytes)) return false;
    counted = counted || record.op == Op::statistics;
    if (!parse(record.op, record.data)) return false;
  }
  return counted && at == end && !channels_.empty();
}

/// Parses a record that describes the file. False if it is broken.
bool McapBag::parse(Op op, std::span<const std::byte> data) {
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
      cursor.bytes(2 * 8);  // first and last time, which the chunk has, too
      index_.insert(cursor.get<std::uint64_t>());
      break;
    }
    case Op::statistics: {
      const auto messages = cursor.get<std::uint64_t>();
      cursor.bytes(2 + 4 * 4 + 2 * 8);
      const auto channels = cursor.get<std::uint32_t>() / 10;
      counted_ = channels > 0 || messages == 0;
      for (auto left = channels; left > 0 && cursor.ok(); --left) {
        const auto id = cursor.get<std::uint16_t>();
        counts_[id] = cursor.get<std::uint64_t>();
      }
      break;
    }
    default: break;
  }
  return cursor.ok();
}

/// Finds chunks by the records' lengths. After a broken record it continues with the next chunk of the index.
void McapBag::find_chunks() {
  std::size_t named = 0;
  Record record;
  for (std::uint64_t at = kMagicSize; at < end_; at = record.end) {
    check_interruption();
    const std::string place = fmt::format("byte {}", at);
    if (!read_record(at, record, kMessageHeader)) {
      const auto next = index_.upper_bound(at);
      faults_.add(next == index_.end() ? "broken or cut records, where reading ends"
                                       : "broken records, behind which reading goes on with the next chunk",
                  place);
      record.end = next == index_.end() ? end_ : *next;
      continue;
    }
    if (record.op == Op::data_end) break;
    if (record.op == Op::message) add_message(at, record);
    if (record.op == Op::chunk) {
      const bool is_named = index_.contains(at);
      named += is_named ? 1 : 0;
      if (!is_named && !index_.empty()) faults_.add("chunks that the index does not name", place);
      ros::Chunk chunk{at, record.end - at};
      if (summarised_ ? read_times(record.data, chunk) : scan(chunk)) chunks_.push_back(chunk);
    }
    const bool describes = record.op == Op::schema || record.op == Op::channel;
    if (describes && !summarised_ && !(read_record(at, record, kMostMcapBytes) && parse(record.op, record.data))) {
      faults_.add("broken records", place);
    }
  }
  if (named < index_.size()) {
    faults_.add("chunks that are not where the index says", "the index",
                static_cast<std::int64_t>(index_.size() - named));
  }
}

/// Adds a message outside of chunks: consecutive ones are loaded as if they were a chunk.
void McapBag::add_message(std::uint64_t offset, const Record& record) {
  constexpr std::uint64_t kMostRun = 4 << 20;
  if (record.data.size() < kMessageHeader) {
    faults_.add("broken records", fmt::format("byte {}", offset));
    return;
  }
  if (!summarised_) ++counts_[load<std::uint16_t>(record.data.data())];
  const std::uint64_t size = record.end - offset;
  const bool follows = !chunks_.empty() && chunks_.back().offset == run_ && run_ + chunks_.back().size == offset;
  if (!follows || chunks_.back().size + size > kMostRun) {
    run_ = offset;
    chunks_.push_back({offset, 0});
  }
  chunks_.back().size += size;
  chunks_.back().add_time(log_time(record.data));
}

/// Reads the times at the beginning of a chunk.
bool McapBag::read_times(std::span<const std::byte> data, ros::Chunk& chunk) {
  ByteCursor cursor(data);
  chunk.start = mcap_time(cursor.get<std::uint64_t>());
  chunk.end = mcap_time(cursor.get<std::uint64_t>());
  return cursor.ok();
}

/// Reads a chunk for what the summary lacks. False for one without messages.
bool McapBag::scan(ros::Chunk& chunk) {
  std::vector<std::byte> bytes;
  for_records(unpack(chunk, bytes), Op::message, [&](Op op, std::span<const std::byte> data) {
    if (op == Op::message) {
      ++counts_[load<std::uint16_t>(data.data())];
      chunk.add_time(log_time(data));
    } else if ((op == Op::schema || op == Op::channel) && !parse(op, data)) {
      faults_.add("broken records", fmt::format("byte {}", chunk.offset));
    }
  });
  return chunk.start <= chunk.end;
}

void McapBag::load_chunk(const ros::Chunk& chunk, ros::LoadedChunk& content) {
  const bool whole =
      for_records(unpack(chunk, content.bytes), Op::message, [&](Op op, std::span<const std::byte> data) {
        if (op != Op::message) return;
        const std::uint32_t channel = load<std::uint16_t>(data.data());
        if (!selected_.contains(channel)) return;
        const ros::Wire wire =
            channels_[static_cast<std::uint16_t>(channel)].encoding == "ros1" ? ros::Wire::ros1 : ros::Wire::cdr;
        content.messages.push_back({log_time(data), {channel, wire, data.subspan(kMessageHeader)}});
      });
  if (!whole) faults_.add("chunks with broken records", fmt::format("byte {}", chunk.offset));
}

/// A chunk's records, in `bytes`. None if it is broken: a fault.
std::span<const std::byte> McapBag::unpack(const ros::Chunk& chunk, std::vector<std::byte>& bytes) {
  bytes.resize(static_cast<std::size_t>(std::min(chunk.size, kMostMcapBytes)));
  if (bytes.size() == chunk.size && file_->read(chunk.offset, bytes) == bytes.size()) {
    if (static_cast<Op>(bytes.front()) != Op::chunk) return bytes;
    if (const auto records = decompress(bytes)) return *records;
  }
  faults_.add("broken chunks", fmt::format("byte {}", chunk.offset));
  return {};
}

/// `bytes`: the chunk's record, which is replaced if it is compressed.
std::optional<std::span<const std::byte>> McapBag::decompress(std::vector<std::byte>& bytes) {
  ByteCursor cursor(bytes);
  cursor.bytes(kRecordHeader + 2 * 8);  // first and last time
  const auto size = cursor.get<std::uint64_t>();
  const auto checksum = cursor.get<std::uint32_t>();
  const std::string compression = field_text(cursor);
  std::span<const std::byte> records = cursor.bytes(cursor.get<std::uint64_t>());
  if (!cursor.ok() || size > kMostMcapBytes) return std::nullopt;
  if (!compression.empty()) {
    const bool unpacked = compression == "lz4"    ? decompress_lz4(records, size, data_)
                          : compression == "zstd" ? decompress_zstd(records, size, data_)
                                                  : false;
    if (!unpacked) return std::nullopt;
    bytes.swap(data_);
    records = bytes;
  }
  if (records.size() != size) return std::nullopt;
  if (checksum != 0 && checksum != crc32_z(0, reinterpret_cast<const Bytef*>(records.data()), records.size())) {
    return std::nullopt;
  }
  return records;
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
