#include "core/events/es/es.hpp"

#include <fmt/format.h>

#include <array>
#include <string_view>

#include "core/events/bytes/bytes.hpp"
#include "core/events/bytes/decoded_reader.hpp"
#include "core/events/es/es_decoder.hpp"
#include "core/support/error.hpp"

namespace evbench {
namespace {

constexpr std::string_view kEsMagic = "Event Stream";
constexpr std::size_t kHeader = 20;
constexpr const char* kKinds[] = {"generic events", "DVS events", "ATIS events", "display events", "color events"};

bool has_magic(std::span<const std::byte> head) {
  return std::string_view(reinterpret_cast<const char*>(head.data()), head.size()).starts_with(kEsMagic);
}

}  // namespace

std::unique_ptr<EventReader> open_es(std::unique_ptr<ByteSource> source, const ReadOptions& options) {
  std::array<std::byte, kHeader> head{};
  const std::size_t size = source->read(0, head);
  const auto fail = [&](const std::string& found, const char* expected) {
    throw InputError(fmt::format("{}: {}; expected {}", source->name(), found, expected));
  };
  if (!has_magic(head)) fail("doesn't begin with \"Event Stream\"", "an Event Stream file");
  if (size < kHeader) fail(fmt::format("is truncated after {} bytes", size), "a header of 20 bytes");
  const auto number = [&](std::size_t at) { return static_cast<int>(head[at]); };
  if (number(12) != 2) fail(fmt::format("has version {}.{}.{}", number(12), number(13), number(14)), "version 2");
  const int kind = number(15);
  if (kind != 1 && kind != 2) {
    fail(kind < 5 ? fmt::format("holds {}", kKinds[kind]) : fmt::format("holds events of kind {}", kind),
         "DVS or ATIS events");
  }
  StreamInfo info;
  info.format = fmt::format("Event Stream {}.{}.{}", number(12), number(13), number(14));
  info.width = load<std::uint16_t>(head.data() + 16);
  info.height = load<std::uint16_t>(head.data() + 18);
  info.metadata.emplace_back("kind", kKinds[kind]);
  if (info.width == 0 || info.height == 0) {
    fail(fmt::format("has a sensor of {}x{} pixels", info.width, info.height), "at least one pixel");
  }
  auto decoder = std::make_unique<EsDecoder>(kind == 1 ? EsDecoder::Kind::dvs : EsDecoder::Kind::atis, info.height);
  return std::make_unique<DecodedReader>(std::move(source), kHeader, std::move(decoder), std::move(info), options);
}

EventFormat es_format() {
  return {"es", "Event Stream, version 2",
          [](const std::string&, std::span<const std::byte> head) { return has_magic(head); },
          [](const std::string& path, const ReadOptions& options) {
            return open_es(std::make_unique<FileBytes>(path), options);
          }};
}

}  // namespace evbench
