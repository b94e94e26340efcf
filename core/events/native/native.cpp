#include "core/events/native/native.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>

#include "core/events/native/metadata.hpp"
#include "core/support/error.hpp"

namespace evbench {

using native::Chunk;
using native::Header;

NativeReader::NativeReader(const std::string& path, const ReadOptions& options)
    : NativeReader(std::make_unique<FileMapping>(path), {}, path, options) {}

NativeReader::NativeReader(std::span<const std::byte> bytes, const std::string& name, const ReadOptions& options)
    : NativeReader(nullptr, bytes, name, options) {}

NativeReader::NativeReader(std::unique_ptr<FileMapping> mapping, std::span<const std::byte> bytes,
                           const std::string& name, const ReadOptions& options)
    : mapping_(std::move(mapping)),
      bytes_(mapping_ ? mapping_->bytes() : bytes),
      name_(name),
      faults_(name, options.strict),
      opening_faults_(faults_) {
  read_header();
  if (info_.width == 0) info_.width = options.width;
  if (info_.height == 0) info_.height = options.height;
  read_index();
  read_metadata();
  opening_faults_ = faults_;
}

void NativeReader::fail(const std::string& message) const { throw InputError(fmt::format("{}: {}", name_, message)); }

void NativeReader::read_header() {
  if (bytes_.size() < sizeof(Header)) {
    fail(fmt::format("has {} bytes; expected a header of {} at least", bytes_.size(), sizeof(Header)));
  }
  std::memcpy(&header_, bytes_.data(), sizeof(Header));
  if (!std::equal(std::begin(header_.magic), std::end(header_.magic), std::begin(native::kMagic))) {
    fail("does not begin as a file of evbench's native format");
  }
  if (header_.version != native::kVersion) {
    fail(fmt::format("is of version {} of the native format, this program reads version {}; convert it again",
                     header_.version, native::kVersion));
  }
  if (native::hash(bytes_.first(offsetof(Header, hash))) != header_.hash) fail("the header is damaged (checksum)");
  if (header_.width > 1 << 16 || header_.height > 1 << 16) {
    fail(fmt::format("the sensor has {} x {} pixels; expected 65536 x 65536 at most", header_.width, header_.height));
  }
  info_.width = static_cast<int>(header_.width);
  info_.height = static_cast<int>(header_.height);
  info_.format = fmt::format("evbench native {}", header_.version);
}

void NativeReader::read_index() {
  // In this order nothing overflows, whatever the header states.
  const std::uint64_t index_size = std::uint64_t{header_.chunks} * sizeof(Chunk), size = bytes_.size();
  if (header_.index_offset > size || index_size > size - header_.index_offset ||
      header_.metadata_size != size - header_.index_offset - index_size) {
    fail(fmt::format("has {} bytes; the header expects {} of chunks, {} of index and {} of metadata: truncated?", size,
                     header_.index_offset, index_size, header_.metadata_size));
  }
  const auto tail = bytes_.subspan(static_cast<std::size_t>(header_.index_offset));
  if (native::hash(tail) != header_.tail_hash) {
    fail(fmt::format("the index at byte {} is damaged (checksum)", header_.index_offset));
  }
  chunks_.resize(header_.chunks);
  if (!chunks_.empty()) std::memcpy(chunks_.data(), tail.data(), static_cast<std::size_t>(index_size));
  verified_.resize(chunks_.size());
  std::uint64_t events = 0, offset = sizeof(Header);
  for (std::size_t i = 0; i < chunks_.size(); ++i) {
    check_chunk(i, offset);
    events += chunks_[i].events;
    offset += native::packed_size(chunks_[i].layout, chunks_[i].events);
  }
  if (events != header_.events || offset != header_.index_offset) {
    fail(fmt::format("the index has {} events in {} bytes, the header {} in {}", events, offset, header_.events,
                     header_.index_offset));
  }
  info_.count = static_cast<std::int64_t>(events);
  if (!chunks_.empty()) {
    info_.start = chunks_.front().start;
    info_.end = chunks_.back().end;
  }
}

/// `offset`: where the chunk must begin.
void NativeReader::check_chunk(std::size_t number, std::uint64_t offset) const {
  const Chunk& chunk = chunks_[number];
  const bool known = chunk.layout == native::Layout::wide ||
                     (chunk.layout == native::Layout::narrow && native::PixelBits(header_.width, header_.height).fit());
  const bool ordered = chunk.start <= chunk.end && (number == 0 || chunks_[number - 1].end <= chunk.start) &&
                       chunk.start > -native::kMaxTime && chunk.end < native::kMaxTime;
  if (!known || !ordered || chunk.offset != offset || chunk.events == 0 || chunk.events > native::kChunkEvents) {
    fail(fmt::format("the index's chunk {} makes no sense: {} events from byte {} on, {} to {} us", number,
                     chunk.events, chunk.offset, chunk.start, chunk.end));
  }
}

void NativeReader::read_metadata() {
  const auto text = bytes_.last(static_cast<std::size_t>(header_.metadata_size));
  RecordingHeader recording = native::parse_metadata(text, info_.width, info_.height, name_);
  info_.metadata = std::move(recording.metadata);
  calibration_ = recording.calibration;
  if (!recording.ground_truth.empty()) ground_truth_ = std::move(recording.ground_truth);
}

bool NativeReader::is_intact(std::size_t number) {
  if (verified_[number]) return true;
  const Chunk& chunk = chunks_[number];
  const auto bytes =
      bytes_.subspan(static_cast<std::size_t>(chunk.offset), native::packed_size(chunk.layout, chunk.events));
  if (native::hash(bytes) == chunk.hash) {
    verified_[number] = true;
    return true;
  }
  faults_.add("events in damaged chunks (checksum)", fmt::format("chunk {} at byte {}", number, chunk.offset),
              chunk.events);
  return false;
}

/// Returns the pages read so far to the kernel, at least a MiB at a time: each call flushes address translations.
void NativeReader::hold(std::size_t offset, std::size_t size) {
  constexpr std::size_t kMost = 1 << 20;
  if (!mapping_) return;
  if (offset != held_end_ || held_end_ - held_begin_ > kMost) {
    mapping_->forget(held_begin_, held_end_ - held_begin_);
    held_begin_ = offset;
  }
  held_end_ = offset + size;
}

bool NativeReader::read(std::vector<Event>& events) {
  while (next_ < chunks_.size()) {
    const std::size_t number = next_++;
    const Chunk& chunk = chunks_[number];
    const auto offset = static_cast<std::size_t>(chunk.offset);
    const std::size_t size = native::packed_size(chunk.layout, chunk.events);
    if (mapping_) mapping_->expect_whole();
    hold(offset, size);
    if (!is_intact(number)) continue;
    events.resize(chunk.events);
    native::unpack(bytes_.subspan(offset, size), chunk, {header_.width, header_.height}, events);
    return true;
  }
  events.clear();
  return false;
}

void NativeReader::seek(std::int64_t t) {
  faults_ = opening_faults_;
  const auto found = std::ranges::partition_point(chunks_, [&](const Chunk& chunk) { return chunk.end < t; });
  next_ = static_cast<std::size_t>(found - chunks_.begin());
}

EventFormat native_format() {
  return {"native", "evbench's own cache: mapped into memory, checksummed",
          [](const std::string&, std::span<const std::byte> head) {
            return head.size() >= sizeof native::kMagic &&
                   std::memcmp(head.data(), native::kMagic, sizeof native::kMagic) == 0;
          },
          [](const std::string& path, const ReadOptions& options) -> std::unique_ptr<EventReader> {
            return std::make_unique<NativeReader>(path, options);
          }};
}

}  // namespace evbench
