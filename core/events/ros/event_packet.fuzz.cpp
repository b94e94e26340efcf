#include "core/events/ros/event_packet.hpp"

#include "core/events/ros/camera_info.hpp"
#include "core/events/ros/messages.hpp"
#include "core/support/error.hpp"

using namespace evbench;

/// The first byte selects the serialisation of the rest; the packet is decoded as its own encoding and as each other.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const auto bytes = std::as_bytes(std::span(data, size)).subspan(1);
  const ros::Wire wire = data[0] % 2 == 0 ? ros::Wire::ros1 : ros::Wire::cdr;
  ros::EventArray array;
  ros::parse_event_array(bytes, wire, array);
  ros::parse_pose_stamped(bytes, wire);
  try {
    if (const auto info = ros::parse_camera_info(bytes, wire)) ros::camera_of(*info, "fuzz", 240, 180);
  } catch (const InputError&) {
  }
  Faults faults("fuzz", false);
  std::vector<Event> events;
  EventPacketDecoder decoder;
  if (const auto packet = ros::parse_event_packet(bytes, wire)) {
    decoder.decode({packet->events, packet->encoding, packet->time_base}, "fuzz", events, faults);
  }
  for (const char* encoding : {"evt3", "libcaer", "libcaer_cmp"})
    decoder.decode({bytes, encoding, 0}, "fuzz", events, faults);
  return 0;
}
