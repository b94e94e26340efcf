#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "core/events/testing/fields.hpp"

/// ROS 1 bags for tests, written by their specification, and messages in ROS 1's serialisation.
namespace evbench::testing::bag_writer {

using testing::bytes;
using testing::text;

struct BagConnection {
  std::string topic, type;
};
struct BagMessage {
  std::uint32_t connection = 0;
  std::int64_t t = 0;  ///< log time [ns]
  std::string data;
};
/// A chunk's entry in an index.
struct BagIndexEntry {
  std::uint64_t offset = 0;
  std::int64_t start = 0, end = 0;  ///< [ns]
};

inline std::string ros_time(std::int64_t t) {
  return bytes(static_cast<std::uint32_t>(t / 1'000'000'000)) + bytes(static_cast<std::uint32_t>(t % 1'000'000'000));
}
inline std::string ros_header(std::int64_t t) { return bytes<std::uint32_t>(0) + ros_time(t) + text("frame"); }

/// dvs_msgs/EventArray of `count` events, 1 µs apart, from t [ns] on.
inline std::string event_array(std::int64_t t, int count, std::uint32_t width = 240, std::uint32_t height = 180) {
  std::string events;
  for (int i = 0; i < count; ++i) {
    events += bytes<std::uint16_t>(3) + bytes<std::uint16_t>(4) + ros_time(t + 1000 * i) + '\1';
  }
  return ros_header(t) + bytes(height) + bytes(width) + bytes(static_cast<std::uint32_t>(count)) + events;
}
/// geometry_msgs/PoseStamped at (x, 0, 0).
inline std::string pose_stamped(std::int64_t t, double x) {
  return ros_header(t) + bytes(x) + bytes(0.0) + bytes(0.0) + bytes(0.0) + bytes(0.0) + bytes(0.0) + bytes(1.0);
}
/// sensor_msgs/CameraInfo.
inline std::string camera_info(std::uint32_t width, std::uint32_t height, const std::string& model = "plumb_bob",
                               const std::vector<double>& D = {-0.4, 0.2, 0.001, 0.002, 0.0},
                               const std::array<double, 9>& K = {199, 0, 120, 0, 198, 90, 0, 0, 1}) {
  std::string data = ros_header(0) + bytes(height) + bytes(width) + text(model);
  data += bytes(static_cast<std::uint32_t>(D.size()));
  for (const double value : D) data += bytes(value);
  for (const double value : K) data += bytes(value);
  return data + std::string(200, '\0');
}

inline std::string bag_record(const std::vector<std::pair<std::string, std::string>>& fields, const std::string& data) {
  std::string header;
  for (const auto& [name, value] : fields) header += text(name + "=" + value);
  return text(header) + text(data);
}
inline std::string op(unsigned char code) { return std::string(1, static_cast<char>(code)); }

/// A bag with its chunks in the given order. `lie` changes the index; an offset of 0 leaves a chunk out of it.
inline std::string bag_of(const std::vector<BagConnection>& connections,
                          const std::vector<std::vector<BagMessage>>& chunks, bool indexed = true,
                          const std::function<void(std::vector<BagIndexEntry>&)>& lie = {}) {
  constexpr std::size_t kBagHeader = 4096;
  const std::string magic = "#ROSBAG V2.0\n";
  std::string connection_records, body;
  for (std::uint32_t id = 0; id < connections.size(); ++id) {
    const auto& [topic, type] = connections[id];
    connection_records +=
        bag_record({{"op", op(7)}, {"conn", bytes(id)}, {"topic", topic}},
                   text("topic=" + topic) + text("type=" + type) + text("md5sum=*") + text("message_definition="));
  }
  std::vector<BagIndexEntry> index;
  std::vector<std::string> counts;
  for (const auto& messages : chunks) {
    BagIndexEntry entry{magic.size() + kBagHeader + body.size(), messages.front().t, messages.front().t};
    std::string content = connection_records;
    std::vector<std::uint32_t> count(connections.size());
    for (const BagMessage& message : messages) {
      content +=
          bag_record({{"op", op(2)}, {"conn", bytes(message.connection)}, {"time", ros_time(message.t)}}, message.data);
      entry.start = std::min(entry.start, message.t);
      entry.end = std::max(entry.end, message.t);
      ++count[message.connection];
    }
    body += bag_record(
        {{"op", op(5)}, {"compression", "none"}, {"size", bytes(static_cast<std::uint32_t>(content.size()))}}, content);
    index.push_back(entry);
    counts.emplace_back();
    for (std::uint32_t id = 0; id < count.size(); ++id) {
      if (count[id] > 0) counts.back() += bytes(id) + bytes(count[id]);
    }
  }
  if (lie) lie(index);
  std::string end = connection_records;
  std::uint32_t named = 0;
  for (std::size_t i = 0; i < index.size(); ++i) {
    if (index[i].offset == 0) continue;
    ++named;
    end += bag_record({{"op", op(6)},
                       {"ver", bytes<std::uint32_t>(1)},
                       {"chunk_pos", bytes(index[i].offset)},
                       {"start_time", ros_time(index[i].start)},
                       {"end_time", ros_time(index[i].end)},
                       {"count", bytes(static_cast<std::uint32_t>(counts[i].size() / 8))}},
                      counts[i]);
  }
  const std::uint64_t position = indexed ? magic.size() + kBagHeader + body.size() : 0;
  std::string bag = bag_record({{"op", op(3)},
                                {"index_pos", bytes(position)},
                                {"conn_count", bytes(static_cast<std::uint32_t>(connections.size()))},
                                {"chunk_count", bytes(named)}},
                               "");
  const std::size_t padding = kBagHeader - bag.size();
  bag.replace(bag.size() - 4, 4, text(std::string(padding, ' ')));
  return magic + bag + body + (indexed ? end : "");
}

}  // namespace evbench::testing::bag_writer
