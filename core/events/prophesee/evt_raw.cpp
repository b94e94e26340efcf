#include "core/events/prophesee/evt_raw.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "core/events/bytes/decoded_reader.hpp"
#include "core/events/prophesee/evt21_decoder.hpp"
#include "core/events/prophesee/evt2_decoder.hpp"
#include "core/events/prophesee/evt3_decoder.hpp"
#include "core/events/prophesee/header.hpp"
#include "core/support/error.hpp"

namespace evbench {
namespace {

/// The encoding of a RAW file: "2", "2.1" or "3", or the text of another one; empty if the header names none.
std::string encoding(const PropheseeHeader& header) {
  const std::string format = header.value("format"), version = header.value("evt");
  if (format == "EVT2" || version == "2.0" || version == "2") return "2";
  if (format == "EVT21" || version == "2.1") return "2.1";
  if (format == "EVT3" || version == "3.0" || version == "3") return "3";
  return format.empty() ? version : format;
}

/// Recognises RAW files of any encoding, including those that evbench does not read. A comment of a text file may look
/// like the name of an encoding, but text has no bytes below tabs.
bool is_raw(std::span<const std::byte> head) {
  if (head.size() < 2 || head[0] != std::byte{'%'}) return false;
  try {
    const PropheseeHeader header = parse_prophesee_header(head, "");
    const std::string name = encoding(header);
    const auto data = head.subspan(static_cast<std::size_t>(header.size));
    return name == "2" || name == "2.1" || name == "3" || name.starts_with("EVT") ||
           (!name.empty() && std::ranges::any_of(data, [](std::byte byte) { return byte < std::byte{0x09}; }));
  } catch (const InputError&) {
    return false;
  }
}

PropheseeHeader read_header(ByteSource& source, const std::string& expected) {
  PropheseeHeader header = read_prophesee_header(source);
  const std::string found = encoding(header);
  if (found != expected) {
    throw InputError(
        fmt::format("{}: has encoding \"{:.40}\" in its header; expected EVT {}", source.name(), found, expected));
  }
  return header;
}

std::unique_ptr<EventReader> make_reader(std::unique_ptr<ByteSource> source, const PropheseeHeader& header,
                                         std::unique_ptr<EventDecoder> decoder, const std::string& version,
                                         const ReadOptions& options) {
  StreamInfo info = prophesee_info(header, "Prophesee EVT " + version, options, source->name());
  return std::make_unique<DecodedReader>(std::move(source), header.size, std::move(decoder), std::move(info), options);
}

}  // namespace

std::unique_ptr<EventReader> open_evt2(std::unique_ptr<ByteSource> source, const ReadOptions& options) {
  const PropheseeHeader header = read_header(*source, "2");
  return make_reader(std::move(source), header, std::make_unique<Evt2Decoder>(), "2", options);
}

std::unique_ptr<EventReader> open_evt21(std::unique_ptr<ByteSource> source, const ReadOptions& options) {
  const PropheseeHeader header = read_header(*source, "2.1");
  const auto order = header.value("endianness") == "legacy" ? Evt21Decoder::Order::high_half_first
                                                            : Evt21Decoder::Order::low_half_first;
  return make_reader(std::move(source), header, std::make_unique<Evt21Decoder>(order), "2.1", options);
}

std::unique_ptr<EventReader> open_evt3(std::unique_ptr<ByteSource> source, const ReadOptions& options) {
  const PropheseeHeader header = read_header(*source, "3");
  return make_reader(std::move(source), header, std::make_unique<Evt3Decoder>(), "3", options);
}

EventFormat raw_format() {
  return {"raw", "Prophesee RAW, EVT 2, 2.1 and 3",
          [](const std::string&, std::span<const std::byte> head) { return is_raw(head); },
          [](const std::string& path, const ReadOptions& options) {
            auto source = std::make_unique<FileBytes>(path);
            const std::string found = encoding(read_prophesee_header(*source));
            if (found == "2") return open_evt2(std::move(source), options);
            if (found == "2.1") return open_evt21(std::move(source), options);
            if (found == "3") return open_evt3(std::move(source), options);
            throw InputError(
                fmt::format("{}: has encoding \"{:.40}\" in its header; expected EVT 2, 2.1 or 3", path, found));
          }};
}

}  // namespace evbench
