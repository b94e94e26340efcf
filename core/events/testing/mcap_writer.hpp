#pragma once

#include <lz4frame.h>
#include <zstd.h>

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "core/events/testing/fields.hpp"

/// MCAP files for tests, written by its specification, and what goes into them.
namespace evbench::testing::mcap_writer {

using testing::bytes;
using testing::text;

/// A packet of one libcaer event, in ROS 1's serialisation.
inline std::string packet(std::uint32_t t, const std::string& encoding = "libcaer") {
  return bytes<std::uint32_t>(0) + bytes<std::uint32_t>(7) + bytes<std::uint32_t>(0) + text("camera") +
         bytes<std::uint32_t>(260) + bytes<std::uint32_t>(346) + bytes<std::uint64_t>(0) +
         bytes<std::uint64_t>(7'000'000'000) + text(encoding) + std::string(1, '\0') +
         text(bytes<std::uint32_t>(3u << 17 | 4u << 2 | 3u) + bytes(t));
}

inline std::string record(unsigned char op, const std::string& data) {
  return std::string(1, static_cast<char>(op)) + bytes<std::uint64_t>(data.size()) + data;
}
inline std::string message(std::uint16_t channel, std::uint64_t t, const std::string& data) {
  return record(5, bytes(channel) + bytes<std::uint32_t>(0) + bytes(t) + bytes(t) + data);
}
inline std::string topics(const std::string& encoding = "ros1") {
  return record(3, bytes<std::uint16_t>(1) + text("event_camera_msgs/msg/EventPacket") + text("ros1msg") + text("")) +
         record(4, bytes<std::uint16_t>(9) + bytes<std::uint16_t>(1) + text("/events") + text(encoding) + text(""));
}
/// `start`, `end`: times of its messages [ns].
inline std::string chunk(const std::string& compression, const std::string& records, std::uint64_t start = 0,
                         std::uint64_t end = 0) {
  std::string packed = records;
  if (compression == "lz4") {
    packed.resize(LZ4F_compressFrameBound(records.size(), nullptr));
    packed.resize(LZ4F_compressFrame(packed.data(), packed.size(), records.data(), records.size(), nullptr));
  } else if (compression == "zstd") {
    packed.resize(ZSTD_compressBound(records.size()));
    packed.resize(ZSTD_compress(packed.data(), packed.size(), records.data(), records.size(), 1));
  }
  return record(6, bytes(start) + bytes(end) + bytes<std::uint64_t>(records.size()) + bytes<std::uint32_t>(0) +
                       text(compression) + bytes<std::uint64_t>(packed.size()) + packed);
}
inline std::string mcap(const std::string& records) {
  const std::string magic = "\x89MCAP0\r\n";
  return magic + record(1, text("") + text("test")) + records;
}

/// With a summary: the descriptions of topics, an index of the parts that are chunks, and the message counts of
/// channels.
inline std::string closed_mcap(const std::vector<std::string>& parts, const std::string& topics,
                               const std::vector<std::pair<std::uint16_t, std::uint64_t>>& counts) {
  std::string file = mcap(""), index, channels;
  std::uint32_t chunks = 0;
  for (const std::string& part : parts) {
    if (part.front() == '\6') {
      ++chunks;
      index += record(8, part.substr(9, 16) + bytes<std::uint64_t>(file.size()) + bytes<std::uint64_t>(part.size()) +
                             text("") + bytes<std::uint64_t>(0) + text("") + std::string(16, '\0'));
    }
    file += part;
  }
  file += record(0x0F, bytes<std::uint32_t>(0));
  std::uint64_t messages = 0;
  for (const auto& [channel, count] : counts) {
    messages += count;
    channels += bytes(channel) + bytes(count);
  }
  const auto summary = static_cast<std::uint64_t>(file.size());
  file += topics + index;
  file += record(0x0B, bytes(messages) + bytes<std::uint16_t>(1) + std::string(12, '\0') + bytes(chunks) +
                           std::string(16, '\0') + text(channels));
  file += record(2, bytes(summary) + bytes<std::uint64_t>(0) + bytes<std::uint32_t>(0));
  return file + mcap("").substr(0, 8);
}

}  // namespace evbench::testing::mcap_writer
