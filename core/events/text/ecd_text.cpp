#include "core/events/text/ecd_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string_view>
#include <tuple>
#include <utility>

#include "core/data/calib.hpp"
#include "core/events/bytes/decoded_reader.hpp"
#include "core/events/recording_files.hpp"
#include "core/events/text/event_text.hpp"
#include "core/io/text_reader.hpp"
#include "core/support/error.hpp"

namespace evbench {
namespace {

std::string_view text_of(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

bool is_text(std::span<const std::byte> head) {
  // "#!": of other formats, e.g. AEDAT; "{": JSON, e.g. a config; "<": XML.
  return !head.empty() && !text_of(head).starts_with("#!") && !text_of(head).starts_with("{") &&
         !text_of(head).starts_with("<") && std::none_of(head.begin(), head.end(), [](std::byte byte) {
           return byte < std::byte{0x20} && byte != std::byte{'\n'} && byte != std::byte{'\r'} &&
                  byte != std::byte{'\t'};
         });
}

TextLayout find_layout(ByteSource& source, const ReadOptions& options) {
  constexpr std::size_t kHead = 1 << 16;
  std::vector<std::byte> head(kHead);
  head.resize(source.read(0, head));
  return detect_text_layout(text_of(head), head.size() < kHead, source.name(), options.columns);
}

StreamInfo info_of(const TextLayout& layout, const ReadOptions& options) {
  StreamInfo info;
  info.format = "text";
  info.width = layout.width > 0 ? layout.width : options.width;
  info.height = layout.height > 0 ? layout.height : options.height;
  info.metadata = layout.description();
  if (layout.unit_is_guessed) info.guessed_time_unit = layout.unit;
  return info;
}

/// The Event-Camera Dataset, whose text states no size, was recorded with a DAVIS 240C. The calibration's principal
/// point shows whether this may be one of its recordings: that of other sensors is elsewhere.
bool may_be_davis240(const RecordingFiles& files) {
  constexpr double kTolerance = 25.0;  // [px] from the middle
  if (!files.has("calib.txt")) return false;
  try {
    const auto middle = [](const std::string& path) { return read_calib(path, 240, 180).pinhole; };
    const PinholeCamera camera = files.get("calib.txt", middle);
    return std::abs(camera.cx - 119.5) < kTolerance && std::abs(camera.cy - 89.5) < kTolerance;
  } catch (const InputError&) {
    return false;  // reported when the calibration is read
  }
}

/// Width and height of the first picture in images/; none if there is no PNG.
std::optional<std::pair<int, int>> picture_size(const RecordingFiles& files) {
  // PNG: signature, then the header's length and name, width and height, big-endian.
  constexpr std::string_view kSignature("\x89PNG\r\n\x1A\n\0\0\0\x0DIHDR", 16);
  constexpr int kLargest = 65535;
  const auto pictures = files.matching("images/*.png");
  if (pictures.empty()) return std::nullopt;
  std::array<std::byte, 24> head{};
  files.open(pictures.front())->read(0, head);
  if (text_of(head).substr(0, kSignature.size()) != kSignature) return std::nullopt;
  const auto side = [&](std::size_t at) {
    std::uint32_t value = 0;
    for (std::size_t i = 0; i < 4; ++i) value = value << 8 | static_cast<std::uint32_t>(head[at + i]);
    return value >= 1 && value <= kLargest ? static_cast<int>(value) : 0;
  };
  if (side(16) == 0 || side(20) == 0) return std::nullopt;
  return std::pair(side(16), side(20));
}

/// Used if neither the text nor an option states the size.
void find_sensor(const RecordingFiles& files, StreamInfo& info) {
  if (info.width > 0 || info.height > 0) return;
  if (const auto size = picture_size(files)) {
    std::tie(info.width, info.height) = *size;
    info.metadata.emplace_back("sensor size", "that of the pictures next to the events");
  } else if (may_be_davis240(files)) {
    info.width = 240;
    info.height = 180;
    info.size_assumed = true;
    info.metadata.emplace_back("sensor size", "the Event-Camera Dataset's (DAVIS 240C), as calib.txt fits it");
  }
}

/// How many pictures images.txt names, and their times.
std::string pictures_text(const RecordingFiles& files) {
  std::int64_t count = 0;
  double first = 0.0, last = 0.0;  // [s]
  try {
    files.read("images.txt", [&](const std::string& path) {
      for (TextReader reader(path); reader.next(); ++count) {
        reader.expect_columns(2, "t file");
        last = reader.number(0, "the time");
        if (count == 0) first = last;
      }
    });
  } catch (const InputError& error) {
    return error.what();
  }
  return fmt::format("{} in images.txt, {:.3f} to {:.3f} s", count, first, last);
}

}  // namespace

std::unique_ptr<EventReader> open_text(std::unique_ptr<ByteSource> source, const ReadOptions& options) {
  const TextLayout layout = find_layout(*source, options);
  return std::make_unique<DecodedReader>(std::move(source), layout.begin, std::make_unique<EventTextDecoder>(layout),
                                         info_of(layout, options), options);
}

std::unique_ptr<EventReader> open_ecd_text(const std::string& path, const ReadOptions& options) {
  const RecordingFiles files(path);
  auto source = files.open_events();
  const TextLayout layout = find_layout(*source, options);
  StreamInfo info = info_of(layout, options);
  if (layout.width == 0) find_sensor(files, info);
  std::vector<std::string> companions;
  for (const char* name : {"calib.txt", "groundtruth.txt", "images.txt", "imu.txt"}) {
    if (files.has(name) && files.path(name) != path) companions.emplace_back(name);
  }
  if (!companions.empty()) info.metadata.emplace_back("companion files", fmt::to_string(fmt::join(companions, ", ")));
  if (files.has("images.txt")) info.metadata.emplace_back("pictures", pictures_text(files));
  return std::make_unique<DecodedReader>(std::move(source), layout.begin, std::make_unique<EventTextDecoder>(layout),
                                         std::move(info), options);
}

EventFormat ecd_text_format() {
  return {"ecd_text",
          "text, a line an event: Event-Camera Dataset (file, folder, .zip), CSV, also compressed (.txt.gz)",
          [](const std::string& path, std::span<const std::byte> head) {
            if (!is_compressed_file(head)) return is_text(head) || text_of(head).starts_with("PK\3\4");
            std::array<std::byte, 512> content{};
            return is_text(std::span(content).first(open_compressed_file(path)->read(0, content)));
          },
          open_ecd_text, true};
}

}  // namespace evbench
