#include "bench/micro/bag_libraries.hpp"

#ifdef EVBENCH_ROSBAG_STORAGE

#include <rosbag/bag.h>
#include <rosbag/view.h>

namespace {

/// A message's bytes where the library has them.
struct RawMessage {
  std::span<const std::byte> data;
};

/// dvs_msgs/EventArray as ROS's generated code has it; of its vectors, ROS's own reading doesn't compile as C++20.
struct DvsEvent {
  std::uint16_t x, y;
  ros::Time ts;
  std::uint8_t polarity;
};
struct DvsEventArray {
  std::uint32_t sequence;
  ros::Time stamp;
  std::string frame;
  std::uint32_t height, width;
  std::vector<DvsEvent> events;
};

}  // namespace

namespace ros {

// "*" is any type to rosbag.
template <>
struct message_traits::MD5Sum<RawMessage> {
  static const char* value() { return "*"; }
};
template <>
struct message_traits::MD5Sum<DvsEventArray> {
  static const char* value() { return "*"; }
};
template <>
struct serialization::Serializer<RawMessage> {
  template <class Stream>
  static void read(Stream& stream, RawMessage& message) {
    message.data = std::as_bytes(std::span(stream.getData(), stream.getLength()));
  }
};
template <>
struct serialization::Serializer<DvsEvent> {
  template <class Stream>
  static void read(Stream& stream, DvsEvent& event) {
    stream.next(event.x);
    stream.next(event.y);
    stream.next(event.ts);
    stream.next(event.polarity);
  }
};
template <>
struct serialization::Serializer<DvsEventArray> {
  template <class Stream>
  static void read(Stream& stream, DvsEventArray& message) {
    stream.next(message.sequence);
    stream.next(message.stamp);
    stream.next(message.frame);
    stream.next(message.height);
    stream.next(message.width);
    std::uint32_t count = 0;
    stream.next(count);
    message.events.resize(count);
    for (DvsEvent& event : message.events) stream.next(event);
  }
};

}  // namespace ros

namespace evbench {

std::vector<WayToRead> rosbag_storage_ways(const std::string& path, bool dvs_msgs) {
  const auto raw = [path] {
    rosbag::Bag bag(path);
    rosbag::View view(bag);
    Delivered delivered;
    for (const rosbag::MessageInstance& message : view) delivered.add(message.instantiate<RawMessage>()->data);
    return delivered;
  };
  const auto arrays = [path] {
    rosbag::Bag bag(path);
    rosbag::View view(bag, rosbag::TypeQuery("dvs_msgs/EventArray"));
    Delivered delivered;
    for (const rosbag::MessageInstance& message : view) {
      delivered.add(std::as_bytes(std::span(message.instantiate<DvsEventArray>()->events)));
    }
    return delivered;
  };
  std::vector<WayToRead> ways = {{"library, bytes", raw}};
  if (dvs_msgs) ways.push_back({"library, dvs_msgs", arrays});
  return ways;
}

}  // namespace evbench

#else

namespace evbench {

std::vector<WayToRead> rosbag_storage_ways(const std::string&, bool) { return {}; }

}  // namespace evbench

#endif
