#include "core/events/ros/chunk_order.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "core/support/interruption.hpp"

namespace evbench::ros {

ChunkOrder::ChunkOrder(Load load, Faults& faults, std::size_t most_bytes)
    : load_(std::move(load)), faults_(faults), most_bytes_(most_bytes) {}

void ChunkOrder::begin(const std::vector<Chunk>& chunks, std::int64_t from) {
  from_ = from;
  given_ = false;
  open_.clear();
  bytes_ = 0;
  std::vector<Closed> closed;
  for (const Chunk& chunk : chunks) {
    if (chunk.end >= from) closed.push_back({{chunk.start, chunk.offset}, chunk});
  }
  closed_ = decltype(closed_)(std::greater<>(), std::move(closed));
}

std::optional<Message> ChunkOrder::next() {
  if (given_) advance();
  while (!closed_.empty() && (open_.empty() || closed_.top().place < open_.begin()->first)) {
    const Closed closed = closed_.top();
    closed_.pop();
    open(closed);
  }
  given_ = !open_.empty();
  if (!given_) return std::nullopt;
  const Open& first = open_.begin()->second;
  return first.content.messages[first.next].message;
}

/// Moves on after a message that was returned.
void ChunkOrder::advance() {
  auto first = open_.extract(open_.begin());
  Open& chunk = first.mapped();
  if (++chunk.next == chunk.content.messages.size()) {
    recycle(chunk);
  } else {
    first.key().first = chunk.content.messages[chunk.next].t;
    open_.insert(std::move(first));
  }
}

void ChunkOrder::open(const Closed& closed) {
  check_interruption();
  Open chunk{closed.chunk, std::move(spare_), closed.given};
  auto& messages = chunk.content.messages;
  messages.clear();
  const Faults before = faults_;
  load_(closed.chunk, chunk.content);
  if (closed.again) faults_ = before;
  if (!std::ranges::is_sorted(messages, {}, &LoadedChunk::Entry::t)) {
    std::ranges::stable_sort(messages, {}, &LoadedChunk::Entry::t);
  }
  if (!closed.again && !messages.empty() &&
      (messages.front().t < closed.chunk.start || messages.back().t > closed.chunk.end)) {
    faults_.add("chunks with messages of other times than the index says", fmt::format("byte {}", closed.chunk.offset));
  }
  while (chunk.next < messages.size() && messages[chunk.next].t < from_) ++chunk.next;
  chunk.bytes = chunk.content.bytes.capacity() + messages.capacity() * sizeof(LoadedChunk::Entry);
  bytes_ += chunk.bytes;
  if (chunk.next >= messages.size()) {
    recycle(chunk);
    return;
  }
  const Place place(messages[chunk.next].t, closed.chunk.offset);
  open_.emplace(place, std::move(chunk));
  while (bytes_ > most_bytes_ && open_.size() > 1) close_last();
}

/// Closes the chunk that is needed last. Its next message is known from now on, so that it is loaded only once more.
void ChunkOrder::close_last() {
  const auto last = std::prev(open_.end());
  closed_.push({last->first, last->second.chunk, last->second.next, true});
  recycle(last->second);
  open_.erase(last);
}

void ChunkOrder::recycle(Open& chunk) {
  bytes_ -= chunk.bytes;
  spare_ = std::move(chunk.content);
}

}  // namespace evbench::ros
