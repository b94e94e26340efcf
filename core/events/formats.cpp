#include "core/events/formats.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "core/events/companions/companions.hpp"
#include "core/events/event_stream.hpp"
#include "core/io/byte_source.hpp"
#include "core/io/spool.hpp"
#include "core/support/interruption.hpp"

namespace evbench {
namespace {

/// The beginning of a file; empty for a folder.
std::vector<std::byte> read_head(const std::string& path) {
  constexpr std::size_t kHead = 1 << 16;
  std::vector<std::byte> head;
  if (std::filesystem::is_directory(path)) return head;
  FileBytes file(path);
  head.resize(kHead);
  head.resize(file.read(0, head));
  if (head.empty()) throw InputError(fmt::format("{}: is empty; expected events", path));
  return head;
}

const EventFormat* find_format(const std::string& path, std::span<const std::byte> head) {
  for (const EventFormat& format : event_formats()) {
    if (format.recognises(path, head)) return &format;
  }
  return nullptr;
}

/// Checks the names of topics: a reader would silently ignore one that the recording does not have.
void check_topics(const std::string& path, const StreamInfo& info, const ReadOptions& options) {
  if (!options.topic.empty() && info.topics.empty()) {
    throw InputError(fmt::format("{}: has no topics or groups, of which {} would be one", path, options.topic));
  }
  for (const std::string& name : {options.ground_truth_topic, options.camera_info_topic}) {
    const auto is_it = [&](const std::string& topic) { return topic.starts_with(name + " ("); };
    if (!name.empty() && std::ranges::none_of(info.topics, is_it)) {
      throw InputError(fmt::format("{}: has no topic {}; it has {}", path, name,
                                   info.topics.empty() ? "none" : fmt::format("{}", fmt::join(info.topics, ", "))));
    }
  }
}

/// Opens a regular file or a folder.
std::unique_ptr<EventReader> open_recording(const std::string& path, const ReadOptions& options) {
  const auto files = std::make_shared<const RecordingFiles>(path);
  std::string events = files->events();
  if (events.empty()) events = path;  // a folder that is a format itself
  const std::vector<std::byte> head = read_head(events);
  if (const EventFormat* format = find_format(events, head)) {
    if (!options.columns.empty() && !format->has_columns) {
      throw InputError(fmt::format("{}: has no columns, which {} would name: it is {}", events, options.columns,
                                   format->description));
    }
    auto reader = format->open(events, options);
    check_topics(events, reader->info(), options);
    return with_companions(std::move(reader), files, options);
  }
  if (std::filesystem::is_directory(path) && events == path) {
    throw InputError(
        fmt::format("{}: is a folder that is no recording (e.g. with an events.txt); expected one, or a "
                    "file of events",
                    path));
  }
  if (!head.empty() && head.front() == std::byte{'<'}) {
    throw InputError(fmt::format("{}: is XML, e.g. a calibration or settings of DV; expected events", events));
  }
  std::vector<std::string> names;
  for (const EventFormat& format : event_formats()) names.push_back(format.name);
  throw InputError(fmt::format("{}: is of no known event format; known: {}", events, fmt::join(names, ", ")));
}

}  // namespace

std::unique_ptr<EventReader> open_events(const std::string& path, const ReadOptions& options) {
  const std::string readable = seekable_path(path);
  if (readable == path) return open_recording(path, options);
  try {
    return open_recording(readable, options);
  } catch (const Interrupted&) {
    throw;
  } catch (const InputError& error) {
    std::string message = error.what();
    if (const auto at = message.find(readable); at != std::string::npos) message.replace(at, readable.size(), path);
    throw InputError(message);
  }
}

bool holds_events(const std::string& path) {
  if (!std::filesystem::is_directory(path)) return std::filesystem::exists(path);
  return !RecordingFiles(path).events().empty() || find_format(path, {}) != nullptr;
}

std::vector<std::string> files_of_events(const std::string& path) {
  if (!std::filesystem::is_directory(path)) return {path};
  const std::string events = RecordingFiles(path).events();
  if (!events.empty()) return {events};
  std::vector<std::string> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(path)) {
    if (entry.is_regular_file()) files.push_back(entry.path().string());
  }
  std::ranges::sort(files);
  return files;
}

// Here and not with the rest of its class, which core needs without any format.
EventStream::EventStream(const std::string& path, const StreamOptions& options)
    : EventStream((options.open ? options.open : open_events)(path, options.read), path, options) {}

}  // namespace evbench
