#include "core/events/bytes/decoded_reader.hpp"

#include <algorithm>
#include <utility>

#include "core/support/interruption.hpp"

namespace evbench {
namespace {

// Both fit into a processor's second cache.
constexpr std::size_t kBuffer = 1 << 18;
constexpr std::size_t kDecodedEvents = 1 << 14;

}  // namespace

DecodedReader::DecodedReader(std::unique_ptr<ByteSource> source, std::uint64_t begin,
                             std::unique_ptr<EventDecoder> decoder, StreamInfo info, const ReadOptions& options)
    : source_(std::move(source)),
      begin_(begin),
      decoder_(std::move(decoder)),
      info_(std::move(info)),
      strict_(options.strict),
      faults_(source_->name(), options.strict),
      buffer_(kBuffer),
      offset_(begin) {}

/// Moves what is left to the buffer's beginning and reads more behind it. False when there is no more.
bool DecodedReader::fill() {
  check_interruption();  // a file may be long and have no events
  std::copy(buffer_.begin() + static_cast<std::ptrdiff_t>(used_),
            buffer_.begin() + static_cast<std::ptrdiff_t>(filled_), buffer_.begin());
  filled_ -= std::exchange(used_, 0);
  const std::size_t got = source_->read(offset_, std::span(buffer_).subspan(filled_));
  filled_ += got;
  offset_ += got;
  return got > 0;
}

bool DecodedReader::read(std::vector<Event>& events) {
  events.resize(kDecodedEvents);
  std::size_t count = 0;
  while (count < kDecodedEvents / 2 && !ended_) {
    const std::span<Event> room = std::span(events).subspan(count);
    const auto progress = decoder_->decode(rest(), offset_ - (filled_ - used_), room, faults_);
    used_ += progress.bytes;
    count += progress.events;
    if (progress.events > 0 || fill()) continue;
    count += decoder_->finish(rest(), offset_ - (filled_ - used_), room, faults_);
    ended_ = true;
  }
  events.resize(count);
  return count > 0;
}

void DecodedReader::seek(std::int64_t) {
  decoder_->reset();
  faults_ = Faults(source_->name(), strict_);
  used_ = filled_ = 0;
  offset_ = begin_;
  ended_ = false;
}

}  // namespace evbench
