#include "core/events/prophesee/header.hpp"

#include <fmt/format.h>
#include <strings.h>

#include <algorithm>
#include <charconv>
#include <string_view>

#include "core/support/error.hpp"

namespace evbench {
namespace {

constexpr std::size_t kLargest = 1 << 16;

struct Sensor {
  const char* plugin;  ///< part of the driver's name
  int width, height;
};
constexpr Sensor kSensors[] = {{"gen3", 640, 480}, {"gen4", 1280, 720}, {"imx636", 1280, 720}, {"genx320", 320, 320}};

std::string trim(std::string_view text) {
  const auto first = text.find_first_not_of(" \t\r");
  if (first == std::string_view::npos) return "";
  return std::string(text.substr(first, text.find_last_not_of(" \t\r") - first + 1));
}

/// "key value" or "key=value".
void add_field(PropheseeHeader& header, std::string_view text, std::string_view separators) {
  const std::string field = trim(text);
  const auto end = field.find_first_of(separators);
  if (field.empty()) return;
  header.fields.emplace_back(field.substr(0, end), end == std::string::npos ? "" : trim(field.substr(end + 1)));
}

/// "% format EVT3;height=720;width=1280".
void add_line(PropheseeHeader& header, std::string_view line) {
  constexpr std::string_view kFormat = "format ";
  if (!line.starts_with(kFormat)) return add_field(header, line, " \t");
  const auto first = line.find(';');
  add_field(header, line.substr(0, first), " ");
  for (auto at = first; at != std::string_view::npos;) {
    const auto next = line.find(';', at + 1);
    add_field(header, line.substr(at + 1, next == std::string_view::npos ? next : next - at - 1), "=");
    at = next;
  }
}

}  // namespace

std::string PropheseeHeader::value(const std::string& name) const {
  for (const auto& [key, value] : fields) {
    if (::strcasecmp(key.c_str(), name.c_str()) == 0) return value;
  }
  return "";
}

PropheseeHeader parse_prophesee_header(std::span<const std::byte> head, const std::string& name) {
  const std::string_view text(reinterpret_cast<const char*>(head.data()), head.size());
  PropheseeHeader header;
  std::size_t at = 0;
  while (text.substr(at).starts_with("% ")) {
    const auto end = text.find('\n', at);
    if (end == std::string_view::npos) {
      throw InputError(fmt::format("{}: has a header that doesn't end within {} bytes", name, text.size()));
    }
    const std::string line = trim(text.substr(at + 2, end - at - 2));
    at = end + 1;
    if (line == "end") break;
    add_line(header, line);
  }
  header.size = at;
  return header;
}

PropheseeHeader read_prophesee_header(ByteSource& source) {
  std::vector<std::byte> head(kLargest);
  head.resize(source.read(0, head));
  return parse_prophesee_header(head, source.name());
}

int parse_sensor_side(const std::string& text, const std::string& what) {
  int value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || value < 1 || value > 65535) {
    throw InputError(fmt::format("{}: is \"{:.40}\"; expected 1 to 65535 pixels", what, text));
  }
  return value;
}

StreamInfo prophesee_info(const PropheseeHeader& header, std::string format, const ReadOptions& options,
                          const std::string& name) {
  StreamInfo info;
  info.format = std::move(format);
  info.metadata = header.fields;
  std::string width = header.value("width"), height = header.value("height");
  if (const std::string geometry = header.value("geometry"); width.empty() && !geometry.empty()) {
    const auto cross = geometry.find('x');
    width = geometry.substr(0, cross);
    height = cross == std::string::npos ? "" : geometry.substr(cross + 1);
  }
  if (!width.empty() || !height.empty()) {
    info.width = parse_sensor_side(width, name + ": width in the header");
    info.height = parse_sensor_side(height, name + ": height in the header");
  } else if (options.width > 0 && options.height > 0) {
    info.width = options.width;
    info.height = options.height;
  } else {
    const std::string plugin = header.value("plugin_name");
    const auto sensor = std::find_if(std::begin(kSensors), std::end(kSensors), [&](const Sensor& candidate) {
      return plugin.find(candidate.plugin) != std::string::npos;
    });
    if (sensor == std::end(kSensors)) return info;
    info.width = sensor->width;
    info.height = sensor->height;
    info.metadata.emplace_back("sensor size",
                               fmt::format("that of {} sensors, as the header has none", sensor->plugin));
  }
  return info;
}

}  // namespace evbench
