#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/events/ros/event_packet.hpp"
#include "core/events/ros/message_source.hpp"
#include "core/support/error.hpp"
#include "core/support/interruption.hpp"

namespace evbench::ros {
namespace {

constexpr std::uint32_t kMostSide = 1 << 16;

bool has_events(const Topic& topic) {
  return topic.readable && (topic.type == "event_camera_msgs/EventPacket" || topic.type == "dvs_msgs/EventArray" ||
                            topic.type == "prophesee_event_msgs/EventArray");
}

std::string describe(const Topic& topic) {
  return fmt::format("{} ({}), {} messages", topic.name, topic.type,
                     topic.count ? fmt::to_string(*topic.count) : "an unknown number of");
}

std::vector<std::string> describe(const std::vector<Topic>& topics) {
  std::vector<std::string> lines;
  for (const Topic& topic : topics) lines.push_back(describe(topic));
  return lines;
}

/// Those with events; a name picks one of them. Topics without messages come last.
Topic choose(const std::string& path, const std::vector<Topic>& topics, const std::string& name) {
  std::vector<Topic> candidates;
  std::copy_if(topics.begin(), topics.end(), std::back_inserter(candidates), has_events);
  std::stable_partition(candidates.begin(), candidates.end(), [](const Topic& topic) { return topic.count != 0; });
  if (candidates.empty()) {
    throw InputError(
        fmt::format("{}: has no topic of events; expected event_camera_msgs/EventPacket or "
                    "dvs_msgs/EventArray, found: {}",
                    path, topics.empty() ? "nothing" : fmt::format("{}", fmt::join(describe(topics), ", "))));
  }
  if (name.empty()) return candidates.front();
  for (const Topic& topic : candidates) {
    if (topic.name == name) return topic;
  }
  throw InputError(fmt::format("{}: has no events in topic '{}'; it has some in: {}", path, name,
                               fmt::join(describe(candidates), ", ")));
}

class BagReader : public EventReader {
 public:
  BagReader(const std::string& path, const std::string& format, const ReadOptions& options, OpenSource open);

  const StreamInfo& info() const override { return info_; }
  bool read(std::vector<Event>& events) override;
  void seek(std::int64_t t) override;
  const Faults& faults() const override { return faults_; }
  std::optional<PoseTrajectory> ground_truth() override;
  std::optional<Camera> calibration() override;

 private:
  std::optional<std::int64_t> next_message(std::vector<Event>& events);
  void look_at_first(const ReadOptions& options);
  void rewind();
  void restart();
  template <class Parse>
  void for_each_of(const std::string& type, Parse parse);

  OpenSource open_;
  std::string path_;
  Faults faults_;  ///< since the beginning or the last seek
  std::unique_ptr<MessageSource> source_;
  Faults open_faults_;  ///< found when the container was opened
  Topic topic_;
  StreamInfo info_;
  EventPacketDecoder decoder_;
  EventArray array_;
  std::uint64_t messages_ = 0;
  bool camera_time_ = false;        ///< times are the camera's, not ROS's
  std::int64_t stamp_ = 0;          ///< of the last packet [ns]
  std::int64_t ros_minus_own_ = 0;  ///< ROS time of the camera's zero [µs]
  std::int64_t turns_ = 0;          ///< added after a seek: the camera's time without its high bits knows no more [µs]
};

BagReader::BagReader(const std::string& path, const std::string& format, const ReadOptions& options, OpenSource open)
    : open_(std::move(open)),
      path_(path),
      faults_(path, options.strict),
      source_(open_(faults_)),
      open_faults_(faults_),
      topic_(choose(path, source_->topics(), options.topic)) {
  info_.format = format;
  info_.topics = describe(source_->topics());
  info_.metadata.emplace_back("events in", topic_.name);
  look_at_first(options);
}

/// What only messages say: sensor, encoding, time.
void BagReader::look_at_first(const ReadOptions& options) {
  source_->select({topic_.id});
  std::vector<Event> events;
  while (events.empty() && next_message(events)) {
  }
  if (info_.width == 0) info_.width = options.width;
  if (info_.height == 0) info_.height = options.height;
  if (!events.empty()) info_.start = events.front().t;
  if (camera_time_ && !events.empty()) {
    ros_minus_own_ = stamp_ / 1000 - events.front().t;
    info_.metadata.emplace_back("ROS time of the camera's zero [us]", fmt::to_string(ros_minus_own_));
  }
  rewind();
}

void BagReader::rewind() {
  source_->select({topic_.id});
  turns_ = 0;
  restart();
}

void BagReader::restart() {
  faults_ = open_faults_;
  decoder_.reset();
  messages_ = 0;
}

/// Appends a message's events and returns the number of them; none at the end.
std::optional<std::int64_t> BagReader::next_message(std::vector<Event>& events) {
  check_interruption();  // messages without events may be many
  const auto message = source_->next();
  if (!message) return std::nullopt;
  const std::size_t before = events.size();
  std::uint32_t width = 0, height = 0;
  const std::string where = fmt::format("message {} of {}", messages_++, topic_.name);
  if (topic_.type == "event_camera_msgs/EventPacket") {
    const auto packet = parse_event_packet(message->data, topic_.wire);
    if (!packet) {
      faults_.add("broken messages", where);
      return 0;
    }
    if (packet->big_endian) {
      faults_.add("packets in big-endian order, which evbench doesn't read", where);
      return 0;
    }
    width = packet->width;
    height = packet->height;
    stamp_ = packet->stamp;
    camera_time_ = packet->encoding == "evt3";
    decoder_.decode({packet->events, packet->encoding, packet->time_base}, where, events, faults_);
    if (turns_ != 0) {
      for (std::size_t i = before; i < events.size(); ++i) events[i].t += turns_;
    }
    if (info_.metadata.size() == 1) info_.metadata.emplace_back("encoding", packet->encoding);
  } else {
    if (!parse_event_array(message->data, topic_.wire, array_)) {
      faults_.add("broken messages", where);
      return 0;
    }
    width = array_.width;
    height = array_.height;
    events.insert(events.end(), array_.events.begin(), array_.events.end());
  }
  if (info_.width == 0 && width <= kMostSide && height <= kMostSide) {
    info_.width = static_cast<int>(width);
    info_.height = static_cast<int>(height);
  }
  return static_cast<std::int64_t>(events.size() - before);
}

bool BagReader::read(std::vector<Event>& events) {
  constexpr std::size_t kEnough = 1 << 15;
  events.clear();
  while (events.size() < kEnough && next_message(events)) {
  }
  return !events.empty();
}

/// By the time of recording, and by the packets' stamps for how often the camera's 24 bits of time have gone round;
/// from the beginning where the events found are later than t.
void BagReader::seek(std::int64_t t) {
  constexpr std::int64_t kMargin = 100'000, kTurn = std::int64_t{1} << 24;  // [µs]
  rewind();
  if (!info_.start || t <= *info_.start) return;
  const std::int64_t ros_time = std::min(t, std::numeric_limits<std::int64_t>::max() / 2000) + ros_minus_own_ - kMargin;
  const auto go = [&] {
    source_->seek(std::max<std::int64_t>(ros_time, 0) * 1000);
    restart();
  };
  go();
  std::vector<Event> events;
  while (events.empty() && next_message(events)) {
  }
  if (camera_time_ && !events.empty()) {
    const std::int64_t expected = stamp_ / 1000 - ros_minus_own_;
    turns_ = kTurn * static_cast<std::int64_t>(std::llround(static_cast<double>(expected - events.front().t) / kTurn));
  }
  if (events.empty() || events.front().t + turns_ > t) {
    rewind();
  } else {
    go();
  }
}

/// Calls parse(message) for the messages of the first topic of a type, those whose name begins most like the events'
/// first. It returns whether there should be more.
template <class Parse>
void BagReader::for_each_of(const std::string& type, Parse parse) {
  const auto likeness = [&](const Topic& topic) {
    const auto [a, b] = std::mismatch(topic.name.begin(), topic.name.end(), topic_.name.begin(), topic_.name.end());
    return a - topic.name.begin();
  };
  const Topic* best = nullptr;
  for (const Topic& topic : source_->topics()) {
    if (!topic.readable || topic.type != type || topic.count == 0) continue;
    if (best == nullptr || likeness(topic) > likeness(*best)) best = &topic;
  }
  if (best == nullptr) return;
  Faults ignored(path_, false);  // of the container: they are counted when its events are read
  const auto source = open_(ignored);
  source->select({best->id});
  for (auto message = source->next(); message && parse(message->data, *best); message = source->next()) {
  }
}

std::optional<PoseTrajectory> BagReader::ground_truth() {
  std::vector<StampedPose> poses;
  const double zero = 1e-6 * static_cast<double>(ros_minus_own_);
  for_each_of("geometry_msgs/PoseStamped", [&](std::span<const std::byte> data, const Topic& topic) {
    auto pose = parse_pose_stamped(data, topic.wire);
    if (pose) pose->t -= zero;
    if (pose && (poses.empty() || pose->t > poses.back().t)) {
      poses.push_back(*pose);
    } else {
      faults_.add("poses that are broken, or not later than the one before", "topic " + topic.name);
    }
    return true;
  });
  if (poses.empty()) return std::nullopt;
  return PoseTrajectory(std::move(poses), path_);
}

std::optional<Camera> BagReader::calibration() {
  std::optional<Camera> camera;
  for_each_of("sensor_msgs/CameraInfo", [&](std::span<const std::byte> data, const Topic& topic) {
    camera = parse_camera_info(data, topic.wire);
    return false;
  });
  return camera;
}

}  // namespace

std::string plain_type(std::string type) {
  const std::size_t at = type.find("/msg/");
  return at == std::string::npos ? type : type.erase(at, 4);
}

std::unique_ptr<EventReader> read_bag(const std::string& path, const std::string& format, const ReadOptions& options,
                                      OpenSource open) {
  return std::make_unique<BagReader>(path, format, options, std::move(open));
}

}  // namespace evbench::ros
