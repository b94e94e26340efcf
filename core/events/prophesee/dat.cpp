#include "core/events/prophesee/dat.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "core/events/bytes/bytes.hpp"
#include "core/events/bytes/decoded_reader.hpp"
#include "core/events/prophesee/dat_decoder.hpp"
#include "core/events/prophesee/header.hpp"
#include "core/support/error.hpp"

namespace evbench {
namespace {

constexpr std::size_t kDatRecord = 8;

/// Header lines, none of which names an encoding of RAW files, then bytes that are no text.
bool is_dat(std::span<const std::byte> head) {
  if (head.size() < 2 || head[0] != std::byte{'%'}) return false;
  try {
    const PropheseeHeader header = parse_prophesee_header(head, "");
    const auto data = head.subspan(static_cast<std::size_t>(header.size));
    return header.size > 0 && header.value("evt").empty() && header.value("format").empty() &&
           std::any_of(data.begin(), data.end(), [](std::byte byte) { return byte < std::byte{0x09}; });
  } catch (const InputError&) {
    return false;
  }
}

}  // namespace

std::unique_ptr<EventReader> open_dat(std::unique_ptr<ByteSource> source, const ReadOptions& options) {
  const PropheseeHeader header = read_prophesee_header(*source);
  const std::string& name = source->name();
  if (header.size == 0) throw InputError(fmt::format("{}: has no header; expected lines of \"% key value\"", name));
  const std::string version = header.value("version");
  if (version != "2" && version != "1" && !version.empty()) {
    throw InputError(fmt::format("{}: has version \"{:.40}\" of DAT; expected 1 or 2", name, version));
  }
  std::array<std::byte, 2> type_and_size{};
  if (source->read(header.size, type_and_size) < type_and_size.size()) {
    throw InputError(fmt::format("{}: ends behind its header; expected type and size of the events", name));
  }
  const auto type = static_cast<int>(type_and_size[0]), size = static_cast<int>(type_and_size[1]);
  if ((type != 0x00 && type != 0x0C) || size != kDatRecord) {
    throw InputError(
        fmt::format("{}: has events of type 0x{:02X} and {} bytes; expected 0x00 or 0x0C and 8 bytes "
                    "(brightness changes)",
                    name, type, size));
  }
  StreamInfo info = prophesee_info(header, "Prophesee DAT " + (version.empty() ? "1" : version), options, name);
  const std::uint64_t begin = header.size + type_and_size.size();
  info.count = static_cast<std::int64_t>((source->size() - begin) / kDatRecord);
  auto decoder = std::make_unique<DatDecoder>(version == "2" ? DatDecoder::Version::two : DatDecoder::Version::one);
  return std::make_unique<DecodedReader>(std::move(source), begin, std::move(decoder), std::move(info), options);
}

EventFormat dat_format() {
  return {"dat", "Prophesee DAT, versions 1 and 2",
          [](const std::string&, std::span<const std::byte> head) { return is_dat(head); },
          [](const std::string& path, const ReadOptions& options) {
            return open_dat(std::make_unique<FileBytes>(path), options);
          }};
}

}  // namespace evbench
