#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "core/events/faults.hpp"
#include "core/events/reader.hpp"
#include "core/events/ros/messages.hpp"

namespace evbench::ros {

/// One publisher's part of a topic: a connection of ROS 1, a channel of MCAP, a row of ROS 2's table.
struct Connection {
  std::uint32_t id = 0;
  std::string topic;
  std::string type;                    ///< ROS 1's spelling, "geometry_msgs/PoseStamped"
  std::optional<std::uint64_t> count;  ///< of messages
  bool readable = true;                ///< false: in a serialisation that evbench doesn't read
};

struct Message {
  std::uint32_t connection = 0;
  Wire wire = Wire::ros1;
  std::span<const std::byte> data;  ///< valid until the next call
};

/// The messages of a bag, whatever its container. Throws InputError for a file that is no bag. Broken content is a
/// fault and skipped; a file that is cut short ends there.
class MessageSource {
 public:
  virtual ~MessageSource() = default;
  virtual const std::vector<Connection>& connections() const = 0;
  /// Restricts next() to these connections, from the beginning on.
  virtual void select(std::set<std::uint32_t> connections) = 0;
  /// The next message, in the order of the times of recording (log time); none at the end.
  virtual std::optional<Message> next() = 0;
  /// Continues with the first message that was recorded at or after t [ns].
  virtual void seek(std::int64_t t) = 0;
};

/// Opens a container. Broken content is added to the faults, which must outlive it.
using OpenSource = std::function<std::unique_ptr<MessageSource>(Faults&)>;

/// A type in ROS 1's spelling: "geometry_msgs/PoseStamped" for "geometry_msgs/msg/PoseStamped".
std::string plain_type(std::string type);

/// The reader of events in a bag. Calls `open` again for ground truth and for calibration.
///
/// Times of dvs_msgs, and of packets from iniVation's cameras, are ROS times; those of EVT 3 packets are the camera's
/// own, and ground truth is then given in the camera's time, by the stamp of the first packet (good to the latency of
/// the camera's driver, some ms).
std::unique_ptr<EventReader> read_bag(const std::string& path, const std::string& format, const ReadOptions& options,
                                      OpenSource open);

}  // namespace evbench::ros
