#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/events/ros/camera_info.hpp"
#include "core/events/ros/event_packet.hpp"
#include "core/events/ros/message_source.hpp"
#include "core/events/ros/topic_choice.hpp"
#include "core/support/error.hpp"
#include "core/support/interruption.hpp"

namespace evbench::ros {
namespace {

constexpr std::uint32_t kMostSide = 1 << 16;
constexpr std::int64_t kPause = 250'000'000;  ///< [ns] between packets: the counter of their times may have wrapped

constexpr const char *kPoseType = "geometry_msgs/PoseStamped", *kCameraInfoType = "sensor_msgs/CameraInfo";
constexpr TopicKind kEvents{"events", "--topic (source.topic in a run's config)"},
    kPoses{"poses", "--ground-truth-topic (source.ground_truth_topic in a run's config)"},
    kCameraInfos{"camera infos", "--camera-info-topic (source.camera_info_topic in a run's config)"};

/// Topics of one of the types, those without messages last.
std::vector<Candidate> candidates_of(const std::vector<Topic>& topics, std::initializer_list<std::string_view> types) {
  std::vector<Candidate> candidates;
  for (const Topic& topic : topics) {
    if (topic.readable && std::ranges::count(types, topic.type) > 0) candidates.push_back({topic, topic.name});
  }
  std::stable_partition(candidates.begin(), candidates.end(),
                        [](const Candidate& candidate) { return candidate.topic.count != 0; });
  return candidates;
}

std::vector<Candidate> with_messages(const std::vector<Topic>& topics, const char* type) {
  auto candidates = candidates_of(topics, {type});
  std::erase_if(candidates, [](const Candidate& candidate) { return candidate.topic.count == 0; });
  return candidates;
}

std::vector<std::string> descriptions(const std::vector<Topic>& topics) {
  std::vector<std::string> lines;
  for (const Topic& topic : topics) lines.push_back(describe(topic));
  return lines;
}

/// Which events are read: those that the option names, or the first ones.
std::size_t choose_events(const std::string& path, const std::vector<Topic>& topics,
                          const std::vector<Candidate>& candidates, const std::string& name) {
  if (candidates.empty()) {
    throw InputError(
        fmt::format("{}: has no topic of events; expected event_camera_msgs/EventPacket or "
                    "dvs_msgs/EventArray, found: {}",
                    path, topics.empty() ? "nothing" : fmt::format("{}", fmt::join(descriptions(topics), ", "))));
  }
  return name.empty() ? 0 : *choose(path, kEvents, candidates, name, "");
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
  void choose_topic();
  void read_first_message();
  void rewind();
  void restart();
  void synchronise(std::int64_t t, const std::string& where);
  void note(const std::string& key, const std::string& text);
  std::vector<std::optional<CameraInfo>> first_infos(const std::vector<Candidate>& candidates);
  std::string mismatch(const std::optional<CameraInfo>& info) const;
  template <class Take>
  void for_each(const std::set<std::uint32_t>& connections, Take take);

  OpenSource open_;
  std::string path_;
  ReadOptions options_;
  Faults faults_;  ///< since the beginning or the last seek
  std::unique_ptr<MessageSource> source_;
  Faults open_faults_;  ///< found when the container was opened
  std::vector<Topic> topics_;
  Topic topic_;  ///< of the events
  StreamInfo info_;
  EventPacketDecoder decoder_;
  EventArray array_;
  std::uint64_t messages_ = 0;
  bool encoding_is_noted_ = false;
  bool camera_time_ = false;        ///< times are the camera's, not ROS's
  std::int64_t stamp_ = 0;          ///< of the last packet [ns]
  std::int64_t ros_minus_own_ = 0;  ///< ROS time of the camera's zero [µs]
  bool zero_is_known_ = false;      ///< ros_minus_own_ is
  bool synchronised_ = false;       ///< turns_ is right for the packets that follow
  std::int64_t turns_ = 0;          ///< added to times after a seek or a pause [µs]
};

BagReader::BagReader(const std::string& path, const std::string& format, const ReadOptions& options, OpenSource open)
    : open_(std::move(open)),
      path_(path),
      options_(options),
      faults_(path, options.strict),
      source_(open_(faults_)),
      open_faults_(faults_),
      topics_(topics_of(source_->connections())) {
  info_.format = format;
  info_.topics = descriptions(topics_);
  choose_topic();
  // A name that does not exist is reported at once.
  const auto check = [&](const TopicKind& kind, const char* type, const std::string& name) {
    if (!name.empty()) choose(path, kind, with_messages(topics_, type), name, topic_.name);
  };
  check(kPoses, kPoseType, options.ground_truth_topic);
  check(kCameraInfos, kCameraInfoType, options.camera_info_topic);
  read_first_message();
}

void BagReader::choose_topic() {
  auto candidates = candidates_of(
      topics_, {"event_camera_msgs/EventPacket", "dvs_msgs/EventArray", "prophesee_event_msgs/EventArray"});
  for (Candidate& candidate : candidates) candidate.text = describe(candidate.topic);
  const std::size_t chosen = choose_events(path_, topics_, candidates, options_.topic);
  topic_ = candidates[chosen].topic;
  note("events in", topic_.name);
  const bool several = candidates.size() > 1 && candidates[1].topic.count != 0;
  if (several && options_.topic.empty()) note(kTopicChoice, choice_text(kEvents, candidates, chosen));
}

/// Adds a line to the metadata, once.
void BagReader::note(const std::string& key, const std::string& text) {
  std::pair line(key, text);
  if (std::ranges::count(info_.metadata, line) == 0) info_.metadata.push_back(std::move(line));
}

/// Finds what only messages contain: sensor, encoding, time.
void BagReader::read_first_message() {
  source_->select(topic_.connections);
  std::vector<Event> events;
  while (events.empty() && next_message(events)) {
  }
  if (info_.width == 0) info_.width = options_.width;
  if (info_.height == 0) info_.height = options_.height;
  if (!events.empty()) info_.start = events.front().t;
  if (camera_time_ && !events.empty()) {
    ros_minus_own_ = stamp_ / 1000 - events.front().t;
    zero_is_known_ = true;
    note("ROS time of the camera's zero [us]", fmt::to_string(ros_minus_own_));
  }
  rewind();
}

void BagReader::rewind() {
  source_->select(topic_.connections);
  turns_ = 0;
  restart();
}

void BagReader::restart() {
  faults_ = open_faults_;
  decoder_.reset();
  synchronised_ = false;
  messages_ = 0;
}

/// Appends a message's events and returns their number; none at the end.
std::optional<std::int64_t> BagReader::next_message(std::vector<Event>& events) {
  check_interruption();  // messages without events may be many
  const auto message = source_->next();
  if (!message) return std::nullopt;
  const std::size_t before = events.size();
  std::uint32_t width = 0, height = 0;
  const std::string where = fmt::format("message {} of {}", messages_++, topic_.name);
  if (topic_.type == "event_camera_msgs/EventPacket") {
    const auto packet = parse_event_packet(message->data, message->wire);
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
    camera_time_ = packet->encoding == "evt3";
    if (camera_time_ && std::abs(packet->stamp - std::exchange(stamp_, packet->stamp)) > kPause) {
      decoder_.reset();
      synchronised_ = false;
    }
    decoder_.decode({packet->events, packet->encoding, packet->time_base}, where, events, faults_);
    if (camera_time_ && !synchronised_ && events.size() > before) synchronise(events[before].t, where);
    if (turns_ != 0) {
      for (std::size_t i = before; i < events.size(); ++i) events[i].t += turns_;
    }
    if (!encoding_is_noted_) note("encoding", packet->encoding);
    encoding_is_noted_ = true;
  } else {
    if (!parse_event_array(message->data, message->wire, array_)) {
      faults_.add("broken messages", where);
      return 0;
    }
    width = array_.width;
    height = array_.height;
    events.insert(events.end(), array_.events.begin(), array_.events.end());
  }
  const bool is_size = width > 0 && height > 0 && width <= kMostSide && height <= kMostSide;
  if (info_.width == 0 && is_size) {
    info_.width = static_cast<int>(width);
    info_.height = static_cast<int>(height);
  }
  return static_cast<std::int64_t>(events.size() - before);
}

/// The camera's 24 bits of time do not show how often they have wrapped while nothing was read. The packet's stamp
/// does, unless the camera was restarted in the meantime.
void BagReader::synchronise(std::int64_t t, const std::string& where) {
  constexpr std::int64_t kTurn = std::int64_t{1} << 24, kMostDrift = 1'000'000;  // [µs]
  synchronised_ = true;
  if (!zero_is_known_) return;
  const std::int64_t ahead = stamp_ / 1000 - ros_minus_own_ - t;
  turns_ = kTurn * static_cast<std::int64_t>(std::llround(static_cast<double>(ahead) / static_cast<double>(kTurn)));
  if (std::abs(ahead - turns_) <= kMostDrift) return;
  faults_.add("restarts of the camera's clock, after which times are the packets' stamps", where);
  turns_ = ahead;
}

bool BagReader::read(std::vector<Event>& events) {
  constexpr std::size_t kEnough = 1 << 15;
  events.clear();
  while (events.size() < kEnough && next_message(events)) {
  }
  return !events.empty();
}

/// Seeks by the time of recording, and finds from the packets' stamps how often the camera's 24 bits of time have
/// wrapped. Starts from the beginning if the events found are later than t.
void BagReader::seek(std::int64_t t) {
  constexpr std::int64_t kMargin = 100'000;  // [µs]
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
  if (events.empty() || events.front().t > t) {
    rewind();
  } else {
    go();
  }
}

/// Calls take(message) for the messages of some connections, until it returns false.
template <class Take>
void BagReader::for_each(const std::set<std::uint32_t>& connections, Take take) {
  Faults ignored(path_, false);  // of the container: they are counted when events are read
  const auto source = open_(ignored);
  source->select(connections);
  for (auto message = source->next(); message && take(*message); message = source->next()) {
  }
}

/// Poses are sorted by their own times: those of several publishers are recorded in another order.
std::optional<PoseTrajectory> BagReader::ground_truth() {
  const auto candidates = with_messages(topics_, kPoseType);
  const auto chosen = choose(path_, kPoses, candidates, options_.ground_truth_topic, topic_.name);
  if (!chosen) return std::nullopt;
  const Topic& topic = candidates[*chosen].topic;
  std::vector<StampedPose> poses;
  const auto leave_out = [&] {
    faults_.add("poses that are broken, or have the time of another one", "topic " + topic.name);
  };
  for_each(topic.connections, [&](const Message& message) {
    auto pose = parse_pose_stamped(message.data, message.wire);
    if (pose) {
      pose->t -= 1e-6 * static_cast<double>(ros_minus_own_);
      poses.push_back(*pose);
    } else {
      leave_out();
    }
    return true;
  });
  std::ranges::stable_sort(poses, {}, &StampedPose::t);
  std::size_t kept = 0;
  for (const StampedPose& pose : poses) {
    if (kept > 0 && pose.t == poses[kept - 1].t) {
      leave_out();
    } else {
      poses[kept++] = pose;
    }
  }
  poses.resize(kept);
  if (poses.empty()) return std::nullopt;
  note(kGroundTruthIn, topic.name);
  if (candidates.size() > 1 && options_.ground_truth_topic.empty()) {
    note(kTopicChoice, choice_text(kPoses, candidates, *chosen));
  }
  return PoseTrajectory(std::move(poses), path_);
}

/// For each candidate the first message of a calibrated camera, or else the last one that is whole.
std::vector<std::optional<CameraInfo>> BagReader::first_infos(const std::vector<Candidate>& candidates) {
  std::set<std::uint32_t> connections;
  for (const Candidate& candidate : candidates) connections.merge(std::set(candidate.topic.connections));
  std::vector<std::optional<CameraInfo>> infos(candidates.size());
  const auto is_good = [](const std::optional<CameraInfo>& info) { return info && is_calibrated(*info); };
  for_each(connections, [&](const Message& message) {
    for (std::size_t i = 0; i < infos.size(); ++i) {
      const bool its = candidates[i].topic.connections.contains(message.connection);
      if (its && !is_good(infos[i])) {
        if (auto info = parse_camera_info(message.data, message.wire)) infos[i] = std::move(info);
      }
    }
    return !std::ranges::all_of(infos, is_good);
  });
  return infos;
}

/// Why a message cannot be the calibration of the events' camera; "" if it can.
std::string BagReader::mismatch(const std::optional<CameraInfo>& info) const {
  if (!info) return "none of its messages is whole";
  if (!is_calibrated(*info)) return "is of a camera that is not calibrated: its focal lengths are 0, as all of K";
  const bool known = info->width > 0 && info->height > 0 && info_.width > 0 && info_.height > 0;
  const auto is = [](std::uint32_t side, int expected) { return side == static_cast<std::uint32_t>(expected); };
  if (!known || (is(info->width, info_.width) && is(info->height, info_.height))) return "";
  return fmt::format("is of another camera than the events of {}, which have {}x{} pixels", topic_.name, info_.width,
                     info_.height);
}

std::optional<Camera> BagReader::calibration() {
  auto candidates = with_messages(topics_, kCameraInfoType);
  const auto infos = first_infos(candidates);
  std::vector<std::string> faults;
  for (std::size_t i = 0; i < infos.size(); ++i) {
    faults.push_back(mismatch(infos[i]));
    candidates[i].fits = faults[i].empty();
    if (infos[i]) candidates[i].text += fmt::format(" ({}x{} pixels)", infos[i]->width, infos[i]->height);
  }
  const auto chosen = choose(path_, kCameraInfos, candidates, options_.camera_info_topic, topic_.name);
  if (!chosen) {
    for (std::size_t i = 0; i < candidates.size(); ++i) {
      note(kUnusableCalibration, fmt::format("{} {}", candidates[i].text, faults[i]));
    }
    return std::nullopt;
  }
  const Candidate& candidate = candidates[*chosen];
  if (!candidate.fits) throw InputError(fmt::format("{}: {} {}", path_, candidate.text, faults[*chosen]));
  note(kCameraInfoIn, candidate.text);
  if (candidates.size() > 1 && options_.camera_info_topic.empty()) {
    note(kTopicChoice, choice_text(kCameraInfos, candidates, *chosen));
  }
  return camera_of(*infos[*chosen], path_ + ": " + candidate.topic.name, info_.width, info_.height);
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
