#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/events/ros/message_source.hpp"

namespace evbench {

/// Content of the metadata.yaml of a ROS 2 recording (rosbag2_storage; versions 1 to 9 of its layout).
struct Ros2Metadata {
  struct File {
    std::string path;
    std::optional<std::int64_t> end;  ///< time of the last message [ns]
  };
  std::vector<File> files;              ///< in the order of recording; all in the recording's folder
  std::vector<ros::Connection> topics;  ///< ids: their places here
  bool messages_compressed = false;     ///< each separately, by zstd
};

/// Throws InputError if the file is no such description, or names a compression other than zstd. Of the files' paths
/// only the names count: in old recordings the folder's original name precedes them.
Ros2Metadata read_ros2_metadata(const std::string& folder);

}  // namespace evbench
