#include "core/events/hdf5/layout.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "core/support/error.hpp"

namespace evbench::hdf5 {
namespace {

std::string parent(const std::string& path) {
  const std::size_t slash = path.rfind('/');
  return slash == std::string::npos ? "" : path.substr(0, slash);
}

std::string join(const std::string& group, const std::string& name) {
  return group.empty() ? name : group + "/" + name;
}

/// The first of these paths that is in the file.
std::string first_of(const File& file, const std::vector<std::string>& paths) {
  for (const std::string& path : paths) {
    if (file.has_dataset(path)) return path;
  }
  return "";
}

std::optional<EventLayout> columns_layout(const File& file, const std::string& group) {
  EventLayout layout;
  layout.group = group;
  for (const std::string suffix : {"", "s"}) {
    if (!file.has_dataset(join(group, "x" + suffix)) || !file.has_dataset(join(group, "y" + suffix)) ||
        !file.has_dataset(join(group, "t" + suffix)) || !file.has_dataset(join(group, "p" + suffix))) {
      continue;
    }
    layout.x = join(group, "x" + suffix);
    layout.y = join(group, "y" + suffix);
    layout.t = join(group, "t" + suffix);
    layout.p = join(group, "p" + suffix);
  }
  if (layout.x.empty()) return std::nullopt;
  const std::string above = parent(group);
  layout.index = first_of(file, {join(above, "ms_to_idx"), join(group, "ms_to_idx"), join(group, "ms_map_idx")});
  layout.offset = first_of(file, {join(above, "t_offset")});
  if (!layout.offset.empty()) {
    layout.name = "DSEC";
    layout.width = 640;
    layout.height = 480;
  } else if (group.starts_with("prophesee/")) {
    layout.name = "M3ED";
    layout.width = 1280;
    layout.height = 720;
  } else if (!layout.index.empty() && group == "events") {
    layout.name = "TUM-VIE";
    layout.width = 1280;
    layout.height = 720;
  } else {
    layout.name = "x, y, t, p";
  }
  return layout;
}

}  // namespace

std::vector<EventLayout> find_events(const File& file) {
  std::vector<EventLayout> layouts;
  std::vector<std::string> groups{""};
  for (const File::Object& object : file.objects()) {
    if (!object.is_dataset) groups.push_back(object.path);
  }
  for (const std::string& group : groups) {
    if (auto layout = columns_layout(file, group)) layouts.push_back(*layout);
    const std::string rows = join(group, "events");
    if (!file.has_dataset(rows)) continue;
    EventLayout layout;
    layout.group = rows;
    layout.name = "rows";
    if (rows.starts_with("davis/")) {
      layout.name = "MVSEC";
      layout.width = 346;
      layout.height = 260;
    }
    layouts.push_back(layout);
  }
  std::sort(layouts.begin(), layouts.end(), [](const auto& a, const auto& b) { return a.group < b.group; });
  return layouts;
}

EventOrder find_order(const EventLayout& layout, const Dataset& rows, const EventOrder& asked) {
  constexpr std::uint64_t kRows = 1000;
  using enum EventColumn;
  const std::string place = rows.name();
  const std::size_t columns = asked.empty() ? 4 : asked.size();
  if (rows.shape().size() != 2 || rows.columns() != columns) {
    throw InputError(
        fmt::format("{}: is {}; expected rows of {} numbers: {}", place, rows.describe(), columns,
                    asked.empty() ? "time, x, y and polarity (--columns names others)" : to_string(asked)));
  }
  const EventOrder x_y_t_p{x, y, t, p};
  if (!asked.empty()) return asked;
  if (layout.name == "MVSEC" || rows.rows() == 0) return x_y_t_p;
  Values values;
  rows.read(0, std::min(rows.rows(), kRows), values);
  const std::vector<double> numbers = values.doubles();
  std::vector<EventRow> sample(numbers.size() / columns);
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    sample[i / columns].values.push_back(numbers[i]);
    sample[i / columns].have_fractions.push_back(numbers[i] != std::floor(numbers[i]));
  }
  const EventOrder orders[] = {{t, x, y, p}, x_y_t_p, {x, y, p, t}};
  return find_event_order(sample, orders, place);
}

TimeUnit find_time_unit(const File& file, const EventLayout& layout) {
  const auto stated_unit = [&](const std::string& object, std::initializer_list<const char*> names) {
    for (const char* name : names) {
      const std::string text = file.text_attribute(object, name);
      if (text.empty()) continue;
      if (const auto unit = parse_time_unit(text)) return *unit;
      throw InputError(
          fmt::format("{}: /{}: attribute {} is \"{:.40}\"; expected s, ms, us or ns, or --columns "
                      "(source.columns in a run's config) with e.g. t_us,x,y,p",
                      file.path(), object, name, text));
    }
    return TimeUnit::unsaid;
  };
  const TimeUnit unit = stated_unit(layout.times(), {"unit", "units", "Unit", "Units", "time_unit", "time_units"});
  if (unit != TimeUnit::unsaid) return unit;
  return stated_unit(layout.is_rows() ? parent(layout.group) : layout.group, {"time_unit", "time_units"});
}

std::optional<std::pair<int, int>> find_sensor_size(const File& file, const std::string& group) {
  constexpr int kLargest = 65536;
  const auto is_side = [](int side) { return side >= 1 && side <= kLargest; };
  for (const std::string& object : {group, std::string()}) {
    const auto width = file.attribute(object, "width"), height = file.attribute(object, "height");
    if (width.size() == 1 && height.size() == 1 && is_side(width[0]) && is_side(height[0])) {
      return std::pair(width[0], height[0]);
    }
    for (const char* name : {"sensor_resolution", "resolution"}) {
      const auto both = file.attribute(object, name);
      if (both.size() == 2 && is_side(both[0]) && is_side(both[1]))
        return std::pair(std::max(both[0], both[1]), std::min(both[0], both[1]));
    }
  }
  return std::nullopt;
}

EventLayout choose_events(const File& file, const std::string& topic) {
  const std::vector<EventLayout> layouts = find_events(file);
  if (layouts.empty()) {
    throw InputError(
        fmt::format("{}: has no events that evbench knows; expected data sets x, y, t, p in a group, or a "
                    "data set 'events' of such rows",
                    file.path()));
  }
  if (topic.empty()) return layouts.front();
  const std::string wanted = topic.front() == '/' ? topic.substr(1) : topic;
  std::vector<std::string> names;
  for (const EventLayout& layout : layouts) {
    if (layout.group == wanted || layout.group.starts_with(wanted + "/")) return layout;
    names.push_back("/" + layout.group);
  }
  throw InputError(
      fmt::format("{}: has no events in '{}'; it has some in: {}", file.path(), topic, fmt::join(names, ", ")));
}

}  // namespace evbench::hdf5
