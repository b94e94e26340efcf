#pragma once

#include <memory>
#include <string>

#include "core/events/formats.hpp"
#include "core/events/ros/message_source.hpp"

namespace evbench {

/// A ROS 2 bag in SQLite (rosbag2_storage_sqlite3): tables topics and messages.
/// `count`: counts the messages of each topic, which takes a while. Throws InputError if SQLite can't open it, or it
/// has other tables.
std::unique_ptr<ros::MessageSource> open_sqlite_bag(const std::string& path, Faults& faults, bool count);

bool is_sqlite(std::span<const std::byte> head);

EventFormat ros2_sqlite_format();

}  // namespace evbench
