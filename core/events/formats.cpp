#include "core/events/formats.hpp"

#include <fmt/format.h>

#include <filesystem>

#include "core/events/formats/all.hpp"
#include "core/support/byte_source.hpp"
#include "core/support/error.hpp"

namespace evbench {
namespace {

std::vector<EventFormat>& all_formats() {
  static std::vector<EventFormat> formats = {
      native_format(),      hdf5_format(), aedat4_format(),  ros1_bag_format(), ros2_folder_format(),
      ros2_sqlite_format(), mcap_format(), evt2_format(),    evt21_format(),    evt3_format(),
      dat_format(),         es_format(),   ecd_text_format()};
  return formats;
}

}  // namespace

std::unique_ptr<EventReader> open_events(const std::string& path, const ReadOptions& options) {
  constexpr std::size_t kHead = 1 << 16;
  std::vector<std::byte> head;
  if (!std::filesystem::is_directory(path)) {
    FileBytes file(path);
    head.resize(kHead);
    head.resize(file.read(0, head));
    if (head.empty()) throw InputError(fmt::format("{}: is empty; expected events", path));
  }
  std::vector<std::string> names;
  for (const EventFormat& format : event_formats()) {
    if (format.recognises(path, head)) return format.open(path, options);
    names.push_back(format.name);
  }
  if (std::filesystem::is_directory(path)) {
    throw InputError(
        fmt::format("{}: is a folder that is no recording (e.g. with an events.txt); expected one, or a "
                    "file of events",
                    path));
  }
  throw InputError(fmt::format("{}: is of no known event format; known: {}", path, fmt::join(names, ", ")));
}

const std::vector<EventFormat>& event_formats() { return all_formats(); }

void add_event_format(EventFormat format) { all_formats().insert(all_formats().begin(), std::move(format)); }

}  // namespace evbench
