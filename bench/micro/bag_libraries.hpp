#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

namespace evbench {

/// What came out of a bag. Every cache line of it is touched, so that nobody gains by leaving pages alone.
struct Delivered {
  std::int64_t messages = 0, bytes = 0;
  std::uint64_t sum = 0;

  void add(std::span<const std::byte> message) {
    constexpr std::size_t kLine = 64;
    ++messages;
    bytes += static_cast<std::int64_t>(message.size());
    for (std::size_t i = 0; i < message.size(); i += kLine) sum += static_cast<std::uint64_t>(message[i]);
  }
};

/// A way of reading a bag to its end.
struct WayToRead {
  std::string name;
  std::function<Delivered()> read;
};

/// librosbag_storage's: the bytes of messages and, if asked for, dvs_msgs/EventArray from them. None when this program
/// was built without it.
std::vector<WayToRead> rosbag_storage_ways(const std::string& path, bool dvs_msgs);

}  // namespace evbench
