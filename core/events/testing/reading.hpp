#pragma once

#include <cstring>
#include <memory>
#include <string>
#include <vector>

#include "core/events/reader.hpp"
#include "core/io/byte_source.hpp"
#include "core/support/error.hpp"
#include "core/testing/catch2.hpp"

namespace evbench::testing {

/// A source that keeps its bytes.
class StringBytes : public ByteSource {
 public:
  explicit StringBytes(std::string bytes) : bytes_(std::move(bytes)), view_(std::as_bytes(std::span(bytes_)), "test") {}
  std::uint64_t size() const override { return view_.size(); }
  std::size_t read(std::uint64_t offset, std::span<std::byte> out) override { return view_.read(offset, out); }
  const std::string& name() const override { return view_.name(); }

 private:
  std::string bytes_;
  MemoryBytes view_;
};

inline std::unique_ptr<ByteSource> bytes_of(std::string content) {
  return std::make_unique<StringBytes>(std::move(content));
}

/// The memory of numbers.
template <class T>
std::string data_of(const std::vector<T>& numbers) {
  return {reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(T)};
}

/// All events of an EventReader or EventStream.
template <class Source>
std::vector<Event> read_all(Source& source) {
  std::vector<Event> all;
  for (std::vector<Event> chunk; source.read(chunk);) all.insert(all.end(), chunk.begin(), chunk.end());
  return all;
}

/// Counts in the order of the names of the faults.
inline std::vector<std::int64_t> fault_counts(const EventReader& reader) {
  std::vector<std::int64_t> counts;
  for (const auto& [kind, fault] : reader.faults().all()) counts.push_back(fault.count);
  return counts;
}

/// A file that is cut at many places, or has bytes changed, is either refused or read: without a crash, with at most 32
/// events a byte, and only with events of the whole file if it is cut.
template <class Open>
void check_survives(const std::string& content, Open open) {
  const auto read = [&](const std::string& bytes) {
    try {
      return read_all(*open(bytes));
    } catch (const InputError&) {
      return std::vector<Event>();
    }
  };
  const std::vector<Event> all = read(content);
  REQUIRE(!all.empty());
  for (std::size_t size = 0; size < content.size(); size += 1 + size / 32) {
    const auto part = read(content.substr(0, size));
    REQUIRE(part.size() <= all.size());
    CHECK(std::equal(part.begin(), part.end(), all.begin()));
  }
  std::uint32_t state = 1;
  const auto random = [&] { return (state = state * 1664525u + 1013904223u) >> 8; };
  for (int round = 0; round < 200; ++round) {
    std::string broken = content;
    for (int i = 0; i < 8; ++i) broken[random() % broken.size()] = static_cast<char>(random());
    CHECK(read(broken).size() <= 32 * broken.size());
  }
}

}  // namespace evbench::testing
