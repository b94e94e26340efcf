#include "core/events/ros/topic_choice.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <tuple>

#include "core/support/error.hpp"

namespace evbench::ros {
namespace {

using Words = std::vector<std::string>;

/// Words of letters and digits, in lower case.
Words words_of(const std::string& name) {
  Words words(1);
  for (const char c : name) {
    if (std::isalnum(static_cast<unsigned char>(c)) != 0) {
      words.back() += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    } else if (!words.back().empty()) {
      words.emplace_back();
    }
  }
  if (words.back().empty()) words.pop_back();
  return words;
}

/// "/davis/left/" of "/davis/left/events".
std::string namespace_of(const std::string& name) { return name.substr(0, name.rfind('/') + 1); }

/// Is the word a usual name of an event camera? davis, davis346, dvs, event_camera, ...
bool names_event_camera(const Words& words) {
  constexpr std::array kBeginnings{"davis", "dvs", "dvx", "event", "prophesee", "metavision", "evk", "celex", "atis"};
  return std::ranges::any_of(words, [&](const std::string& word) {
    return std::ranges::any_of(kBeginnings, [&](const char* beginning) { return word.starts_with(beginning); });
  });
}

/// How likely a topic is the event camera's; more is more likely.
auto likeness(const std::string& name, const std::string& events_topic) {
  const Words words = words_of(name), events = words_of(events_topic);
  const auto in_common =
      std::ranges::count_if(words, [&](const std::string& word) { return std::ranges::count(events, word) > 0; });
  return std::make_tuple(namespace_of(name) == namespace_of(events_topic), in_common, names_event_camera(words));
}

std::string texts(const std::vector<Candidate>& candidates) {
  std::vector<std::string> all;
  for (const Candidate& candidate : candidates) all.push_back(candidate.text);
  return fmt::format("{}", fmt::join(all, ", "));
}

}  // namespace

std::vector<Topic> topics_of(const std::vector<Connection>& connections) {
  std::vector<Topic> topics;
  for (const Connection& connection : connections) {
    auto topic = std::ranges::find_if(topics, [&](const Topic& known) {
      return std::tie(known.name, known.type, known.readable) ==
             std::tie(connection.topic, connection.type, connection.readable);
    });
    if (topic == topics.end()) {
      topics.push_back({connection.topic, connection.type, connection.count, connection.readable, {}});
      topic = std::prev(topics.end());
    } else if (topic->count) {
      topic->count = connection.count ? std::optional(*topic->count + *connection.count) : std::nullopt;
    }
    topic->connections.insert(connection.id);
  }
  return topics;
}

std::string describe(const Topic& topic) {
  return fmt::format("{} ({}), {} messages", topic.name, topic.type,
                     topic.count ? fmt::to_string(*topic.count) : "an unknown number of");
}

std::optional<std::size_t> choose(const std::string& path, const TopicKind& kind,
                                  const std::vector<Candidate>& candidates, const std::string& name,
                                  const std::string& events_topic) {
  std::vector<std::size_t> fitting;
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    if (!name.empty() && candidates[i].topic.name == name) return i;
    if (candidates[i].fits) fitting.push_back(i);
  }
  if (!name.empty()) {
    throw InputError(fmt::format("{}: has no {} in topic '{}'; it has some in: {}", path, kind.what, name,
                                 candidates.empty() ? "none" : texts(candidates)));
  }
  if (fitting.empty()) return std::nullopt;
  const auto like = [&](std::size_t i) { return likeness(candidates[i].topic.name, events_topic); };
  const std::size_t best = *std::ranges::max_element(fitting, {}, like);
  if (std::ranges::count(fitting, like(best), like) > 1) {
    throw InputError(
        fmt::format("{}: has {} in several topics, and no name shows which belong to the camera of {}: "
                    "{}; expected one to be named by {}",
                    path, kind.what, events_topic, texts(candidates), kind.option));
  }
  return best;
}

std::string choice_text(const TopicKind& kind, const std::vector<Candidate>& candidates, std::size_t chosen) {
  return fmt::format("{} are in {}: those in {} are taken; {} chooses others", kind.what, texts(candidates),
                     candidates[chosen].topic.name, kind.option);
}

}  // namespace evbench::ros
