#pragma once

#include <lz4frame.h>
#include <zstd.h>

#include <cstdint>
#include <cstring>
#include <string>

/// MCAP files for tests, written by its specification, and what goes into them.
namespace evbench::testing::mcap_writer {

template <class T>
std::string bytes(T value) {
  std::string text(sizeof(T), '\0');
  std::memcpy(text.data(), &value, sizeof(T));
  return text;
}
inline std::string text(const std::string& characters) {
  return bytes(static_cast<std::uint32_t>(characters.size())) + characters;
}

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
inline std::string chunk(const std::string& compression, const std::string& records) {
  std::string packed = records;
  if (compression == "lz4") {
    packed.resize(LZ4F_compressFrameBound(records.size(), nullptr));
    packed.resize(LZ4F_compressFrame(packed.data(), packed.size(), records.data(), records.size(), nullptr));
  } else if (compression == "zstd") {
    packed.resize(ZSTD_compressBound(records.size()));
    packed.resize(ZSTD_compress(packed.data(), packed.size(), records.data(), records.size(), 1));
  }
  return record(6, bytes<std::uint64_t>(0) + bytes<std::uint64_t>(0) + bytes<std::uint64_t>(records.size()) +
                       bytes<std::uint32_t>(0) + text(compression) + bytes<std::uint64_t>(packed.size()) + packed);
}
inline std::string mcap(const std::string& records) {
  const std::string magic = "\x89MCAP0\r\n";
  return magic + record(1, text("") + text("test")) + records;
}

}  // namespace evbench::testing::mcap_writer
