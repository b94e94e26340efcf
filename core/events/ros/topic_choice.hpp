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

/// A topic that could be meant.
struct Candidate {
  Topic topic;
  std::string text;  ///< for messages: its name, and what tells it from others
  bool fits = true;  ///< false: it is taken only by name
};

/// What candidates are of, "poses", and the option that chooses among them.
struct TopicKind {
  const char* what;
  const char* option;
};

/// The place of the candidate that a name says; without a name the only one that fits, or of several the one that is
/// told to be the event camera's by its name: it is in the same namespace as the events' topic, or has more words in
/// common with it, or the usual name of an event camera. None when none fits. Throws InputError for a name that there
/// is not, and when nothing tells the candidates apart.
std::optional<std::size_t> choose(const std::string& path, const TopicKind& kind,
                                  const std::vector<Candidate>& candidates, const std::string& name,
                                  const std::string& events_topic);

/// The sentence that tells what was chosen from several.
std::string choice_text(const TopicKind& kind, const std::vector<Candidate>& candidates, std::size_t chosen);

}  // namespace evbench::ros
