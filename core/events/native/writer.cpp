#include <fmt/format.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <limits>

#include "core/events/native/metadata.hpp"
#include "core/events/native/native.hpp"
#include "core/support/error.hpp"

namespace evbench {
namespace {

template <class T>
std::span<const std::byte> bytes_of(const T& value) {
  return std::as_bytes(std::span(&value, 1));
}

}  // namespace

NativeWriter::NativeWriter(const std::string& path, const RecordingHeader& header, const std::string& name)
    : name_(name.empty() ? path : name),
      metadata_(native::format_metadata(header)),
      newest_(std::numeric_limits<std::int64_t>::min()),
      file_(std::fopen(path.c_str(), "wb")) {
  if (file_ == nullptr) throw OutputError(fmt::format("{}: can't be written: {}", name_, std::strerror(errno)));
  header_.width = static_cast<std::uint32_t>(header.width);
  header_.height = static_cast<std::uint32_t>(header.height);
  put(bytes_of(native::Header{}));  // reserves its place; without magic bytes until all is written
}

NativeWriter::~NativeWriter() {
  if (file_ != nullptr) std::fclose(static_cast<std::FILE*>(file_));
}

void NativeWriter::put(std::span<const std::byte> bytes) {
  if (std::fwrite(bytes.data(), 1, bytes.size(), static_cast<std::FILE*>(file_)) != bytes.size()) {
    throw OutputError(fmt::format("{}: can't be written: {}", name_, std::strerror(errno)));
  }
  size_ += bytes.size();
}

void NativeWriter::check(const Event& event) const {
  if (event.t < newest_) {
    throw InputError(
        fmt::format("{}: an event of {} us comes after one of {} us; the native format has events in time "
                    "order",
                    name_, event.t, newest_));
  }
  if (event.t <= -native::kMaxTime || event.t >= native::kMaxTime) {
    throw InputError(fmt::format("{}: an event of {} us; the native format holds times within {} us", name_, event.t,
                                 native::kMaxTime));
  }
  if ((header_.width > 0 && event.x >= header_.width) || (header_.height > 0 && event.y >= header_.height)) {
    throw InputError(fmt::format("{}: an event at pixel ({}, {}) is outside the sensor of {}x{} pixels", name_, event.x,
                                 event.y, header_.width, header_.height));
  }
}

void NativeWriter::write(std::span<const Event> events) {
  for (const Event& event : events) {
    check(event);
    newest_ = event.t;
    const bool full = pending_.size() == native::kChunkEvents;
    if (full || (!pending_.empty() && event.t - pending_.front().t > native::kMaxSpan)) end_chunk();
    pending_.push_back(event);
  }
}

void NativeWriter::end_chunk() {
  if (pending_.empty()) return;
  std::vector<std::byte> bytes;
  native::Chunk chunk;
  chunk.offset = size_;
  chunk.events = static_cast<std::uint32_t>(pending_.size());
  chunk.layout = native::pack(pending_, {header_.width, header_.height}, bytes);
  chunk.start = pending_.front().t;
  chunk.end = pending_.back().t;
  chunk.hash = native::hash(bytes);
  put(bytes);
  chunks_.push_back(chunk);
  header_.events += pending_.size();
  pending_.clear();
}

void NativeWriter::finish() {
  end_chunk();
  header_.chunks = static_cast<std::uint32_t>(chunks_.size());
  header_.index_offset = size_;
  header_.metadata_size = metadata_.size();
  const auto index = std::as_bytes(std::span(chunks_)), metadata = std::as_bytes(std::span(metadata_));
  std::vector<std::byte> tail(index.begin(), index.end());
  tail.insert(tail.end(), metadata.begin(), metadata.end());
  header_.tail_hash = native::hash(tail);
  std::memcpy(header_.magic, native::kMagic, sizeof native::kMagic);
  header_.hash = native::hash(bytes_of(header_).first(offsetof(native::Header, hash)));
  put(tail);
  auto* const file = static_cast<std::FILE*>(file_);
  std::rewind(file);
  put(bytes_of(header_));
  file_ = nullptr;
  if (std::fclose(file) != 0) throw OutputError(fmt::format("{}: can't be written: {}", name_, std::strerror(errno)));
}

}  // namespace evbench
