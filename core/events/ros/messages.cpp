#include "core/events/ros/messages.hpp"

#include <cmath>

#include "core/events/bytes/byte_cursor.hpp"

namespace evbench::ros {
namespace {

/// Header of CDR: that it is little-endian, and options, e.g. of padding. Alignment counts from behind it.
constexpr std::size_t kCdrHeader = 4;

/// Reads the fields of a message.
class Fields {
 public:
  Fields(std::span<const std::byte> data, Wire wire) : cursor_(data), wire_(wire) {
    if (wire == Wire::cdr) little_endian_ = (cursor_.get<std::uint32_t>() & 0xFFFF) == 0x0100;
  }
  template <class T>
  T get() {
    if (wire_ == Wire::cdr) cursor_.align(sizeof(T), kCdrHeader);
    return cursor_.get<T>();
  }
  std::string text() {
    std::string text = cursor_.text(get<std::uint32_t>());
    if (wire_ == Wire::cdr && !text.empty()) text.pop_back();  // its zero
    return text;
  }
  std::span<const std::byte> bytes() { return cursor_.bytes(get<std::uint32_t>()); }
  std::span<const std::byte> bytes(std::uint64_t count) { return cursor_.bytes(count); }

  std::int64_t time() {  ///< [ns]
    const std::int64_t seconds = get<std::uint32_t>();
    return seconds * 1'000'000'000 + get<std::uint32_t>();
  }
  std::int64_t header() {  ///< returns its stamp [ns]
    if (wire_ == Wire::ros1) get<std::uint32_t>();
    const std::int64_t stamp = time();
    text();
    return stamp;
  }
  bool ok() const { return cursor_.ok() && little_endian_; }

 private:
  ByteCursor cursor_;
  Wire wire_;
  bool little_endian_ = true;
};

/// Parses events of ROS 1: 13 bytes each, x y seconds nanoseconds polarity.
void load_events(std::span<const std::byte> bytes, std::vector<Event>& events) {
  constexpr std::size_t kSize = 13;
  for (std::size_t i = 0; i < events.size(); ++i) {
    const std::byte* from = bytes.data() + kSize * i;
    events[i] = {std::int64_t{load<std::uint32_t>(from + 4)} * 1'000'000 + load<std::uint32_t>(from + 8) / 1000,
                 load<std::uint16_t>(from), load<std::uint16_t>(from + 2), from[12] != std::byte{0}};
  }
}

}  // namespace

std::optional<EventPacket> parse_event_packet(std::span<const std::byte> data, Wire wire) {
  Fields fields(data, wire);
  EventPacket packet;
  packet.stamp = fields.header();
  packet.height = fields.get<std::uint32_t>();
  packet.width = fields.get<std::uint32_t>();
  fields.get<std::uint64_t>();  // sequence number
  packet.time_base = fields.get<std::uint64_t>();
  packet.encoding = fields.text();
  packet.big_endian = fields.get<std::uint8_t>() != 0;
  packet.events = fields.bytes();
  if (!fields.ok()) return std::nullopt;
  return packet;
}

bool parse_event_array(std::span<const std::byte> data, Wire wire, EventArray& array) {
  Fields fields(data, wire);
  fields.header();
  array.height = fields.get<std::uint32_t>();
  array.width = fields.get<std::uint32_t>();
  const auto count = fields.get<std::uint32_t>();
  array.events.clear();
  if (!fields.ok() || count > data.size() / 13) return false;
  array.events.resize(count);
  if (wire == Wire::ros1) {
    const auto bytes = fields.bytes(13 * std::uint64_t{count});
    if (fields.ok()) load_events(bytes, array.events);
  } else {
    for (Event& event : array.events) {
      event.x = fields.get<std::uint16_t>();
      event.y = fields.get<std::uint16_t>();
      event.t = fields.time() / 1000;
      event.on = fields.get<std::uint8_t>() != 0;
    }
  }
  return fields.ok();
}

std::optional<StampedPose> parse_pose_stamped(std::span<const std::byte> data, Wire wire) {
  Fields fields(data, wire);
  StampedPose pose;
  pose.t = 1e-9 * static_cast<double>(fields.header());
  for (int i = 0; i < 3; ++i) pose.T.p[i] = fields.get<double>();
  for (int i = 0; i < 4; ++i) pose.T.q.coeffs()[i] = fields.get<double>();  // x y z w, as Eigen has them
  const double norm = pose.T.q.norm();
  if (!fields.ok() || !pose.T.p.allFinite() || !(std::abs(norm - 1.0) < 1e-2)) return std::nullopt;
  pose.T.q.normalize();
  return pose;
}

std::optional<CameraInfo> parse_camera_info(std::span<const std::byte> data, Wire wire) {
  Fields fields(data, wire);
  CameraInfo info;
  fields.header();
  info.height = fields.get<std::uint32_t>();
  info.width = fields.get<std::uint32_t>();
  info.distortion_model = fields.text();
  const auto count = fields.get<std::uint32_t>();
  if (count > data.size() / sizeof(double)) return std::nullopt;
  info.D.resize(count);
  for (double& value : info.D) value = fields.get<double>();
  for (double& value : info.K) value = fields.get<double>();
  if (!fields.ok()) return std::nullopt;
  constexpr int kRectification = 9 + 12;  // R, P
  for (int i = 0; i < kRectification; ++i) fields.get<double>();
  const auto binning_x = fields.get<std::uint32_t>(), binning_y = fields.get<std::uint32_t>();
  const auto x = fields.get<std::uint32_t>(), y = fields.get<std::uint32_t>();
  const auto height = fields.get<std::uint32_t>(), width = fields.get<std::uint32_t>();
  const bool is_region = x > 0 || y > 0 || (height > 0 && height < info.height) || (width > 0 && width < info.width);
  info.is_partial = fields.ok() && (binning_x > 1 || binning_y > 1 || is_region);
  return info;
}

}  // namespace evbench::ros
