#include "core/events/formats/ecd_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <string_view>

#include "core/data/calib.hpp"
#include "core/data/tum.hpp"
#include "core/events/codecs/decoded_reader.hpp"
#include "core/events/codecs/event_text.hpp"
#include "core/events/formats/all.hpp"
#include "core/events/formats/ecd_files.hpp"

namespace evbench {
namespace {

std::string_view text_of(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

bool is_text(std::span<const std::byte> head) {
  // "#!": of other formats, e.g. AEDAT.
  return !head.empty() && !text_of(head).starts_with("#!") &&
         std::none_of(head.begin(), head.end(), [](std::byte byte) {
           return byte < std::byte{0x20} && byte != std::byte{'\n'} && byte != std::byte{'\r'} &&
                  byte != std::byte{'\t'};
         });
}

TextLayout find_layout(ByteSource& source) {
  constexpr std::size_t kHead = 1 << 16;
  std::vector<std::byte> head(kHead);
  head.resize(source.read(0, head));
  return detect_text_layout(text_of(head), head.size() < kHead, source.name());
}

StreamInfo info_of(const TextLayout& layout, const ReadOptions& options) {
  StreamInfo info;
  info.format = "text";
  info.width = layout.width > 0 ? layout.width : options.width;
  info.height = layout.height > 0 ? layout.height : options.height;
  info.metadata = layout.description();
  return info;
}

/// With what lies beside the events.
class EcdReader : public DecodedReader {
 public:
  EcdReader(EcdFiles files, std::unique_ptr<ByteSource> source, const TextLayout& layout, StreamInfo info,
            const ReadOptions& options)
      : DecodedReader(std::move(source), layout.begin, std::make_unique<EventTextDecoder>(layout), std::move(info),
                      options),
        files_(std::move(files)) {}

  std::optional<PoseTrajectory> ground_truth() override {
    std::optional<PoseTrajectory> result;
    if (!files_.has("groundtruth.txt")) return result;
    files_.read("groundtruth.txt", [&](const std::string& path) { result = read_tum(path); });
    return result;
  }

  std::optional<Camera> calibration() override {
    std::optional<Camera> result;
    if (!files_.has("calib.txt")) return result;
    files_.read("calib.txt", [&](const std::string& path) { result = read_calib(path, info().width, info().height); });
    return result;
  }

 private:
  EcdFiles files_;
};

}  // namespace

std::unique_ptr<EventReader> open_text(std::unique_ptr<ByteSource> source, const ReadOptions& options) {
  const TextLayout layout = find_layout(*source);
  return std::make_unique<DecodedReader>(std::move(source), layout.begin, std::make_unique<EventTextDecoder>(layout),
                                         info_of(layout, options), options);
}

std::unique_ptr<EventReader> open_ecd_text(const std::string& path, const ReadOptions& options) {
  EcdFiles files(path);
  auto source = files.open_events();
  const TextLayout layout = find_layout(*source);
  StreamInfo info = info_of(layout, options);
  if (const auto size = files.picture_size(); size && layout.width == 0) {
    std::tie(info.width, info.height) = *size;
    info.metadata.emplace_back("sensor size", "that of the pictures beside the events");
  }
  info.topics = files.others();
  return std::make_unique<EcdReader>(std::move(files), std::move(source), layout, std::move(info), options);
}

EventFormat ecd_text_format() {
  return {"ecd_text", "text, a line an event: Event-Camera Dataset (file, folder, .zip) and CSV",
          [](const std::string& path, std::span<const std::byte> head) {
            if (head.empty()) return std::filesystem::is_regular_file(path + "/events.txt");
            return is_text(head) || text_of(head).starts_with("PK\3\4");
          },
          open_ecd_text};
}

}  // namespace evbench
