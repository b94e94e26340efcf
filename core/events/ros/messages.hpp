#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/events/event.hpp"
#include "core/motion/pose_trajectory.hpp"

namespace evbench::ros {

/// How messages are serialised: ROS 1 puts fields next to one another; ROS 2's CDR aligns them (little-endian only).
enum class Wire { ros1, cdr };

/// event_camera_msgs/EventPacket: the bytes of a camera.
struct EventPacket {
  std::int64_t stamp = 0;  ///< of the header [ns]
  std::uint32_t width = 0, height = 0;
  std::uint64_t time_base = 0;  ///< [ns], as the encoding uses it
  std::string encoding;
  bool big_endian = false;
  std::span<const std::byte> events;
};

/// dvs_msgs/EventArray, prophesee_event_msgs/EventArray.
struct EventArray {
  std::uint32_t width = 0, height = 0;
  std::vector<Event> events;  ///< times as ROS has them
};

/// sensor_msgs/CameraInfo; camera_info.hpp makes a camera of it.
struct CameraInfo {
  std::uint32_t width = 0, height = 0;  ///< [px]; 0: unknown
  std::string distortion_model;
  std::vector<double> D;
  std::array<double, 9> K{};
  /// The image is only a part of the sensor or has fewer pixels (region of interest, binning); K is of the whole
  /// sensor.
  bool is_partial = false;
};

// Each returns nothing when the message is broken.
std::optional<EventPacket> parse_event_packet(std::span<const std::byte> data, Wire wire);
bool parse_event_array(std::span<const std::byte> data, Wire wire, EventArray& array);

/// geometry_msgs/PoseStamped; none also for NaN and quaternions that are no rotation.
std::optional<StampedPose> parse_pose_stamped(std::span<const std::byte> data, Wire wire);

std::optional<CameraInfo> parse_camera_info(std::span<const std::byte> data, Wire wire);

}  // namespace evbench::ros
