#pragma once

#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "core/events/ros/message_source.hpp"

namespace evbench::ros {

/// All connections of one name and type.
struct Topic {
  std::string name, type;
  std::optional<std::uint64_t> count;  ///< of messages
  bool readable = true;
  std::set<std::uint32_t> connections;
};

/// In the order of their first connections.
std::vector<Topic> topics_of(const std::vector<Connection>& connections);

/// "/vicon/davis/pose (geometry_msgs/PoseStamped), 100 messages"
std::string describe(const Topic& topic);

/// A topic that may be the one meant.
struct Candidate {
  Topic topic;
  std::string text;  ///< for messages: its name, and what distinguishes it
  bool fits = true;  ///< false: taken only if it is named
};

/// What the candidates have, e.g. "poses", and the option that chooses among them.
struct TopicKind {
  const char* what;
  const char* option;
};

/// Index of the candidate with this name. Without a name it is the only one that fits, or of several the one whose name
/// belongs to the event camera: it is in the same namespace as the events' topic, or has more words in common with it,
/// or the usual name of an event camera. None if none fits. Throws InputError for a name that does not exist, and if
/// several are equally likely.
std::optional<std::size_t> choose(const std::string& path, const TopicKind& kind,
                                  const std::vector<Candidate>& candidates, const std::string& name,
                                  const std::string& events_topic);

/// The sentence that reports what was chosen from several.
std::string choice_text(const TopicKind& kind, const std::vector<Candidate>& candidates, std::size_t chosen);

}  // namespace evbench::ros
