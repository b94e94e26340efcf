#include "core/events/aedat4/aedat4.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>

#include "core/events/aedat4/flat_table.hpp"
#include "core/events/bytes/decompress.hpp"
#include "core/support/error.hpp"

namespace evbench {
namespace {

constexpr std::string_view kAedat4Magic = "#!AER-DAT4.0\r\n", kAnyVersion = "#!AER-DAT";
constexpr std::uint64_t kMostAedat4Header = 16u << 20, kMostAedat4Packet = 256u << 20;
constexpr std::size_t kPacketHeader = 8, kEvent = 16;

/// A number in text; 0 for anything else.
std::int32_t number(const std::string& text) {
  std::int32_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size() ? value : 0;
}

/// The value of name="..." in a tag.
std::string attribute(std::string_view tag, const std::string& name) {
  const std::string before = " " + name + "=\"";
  const std::size_t begin = tag.find(before);
  if (begin == std::string_view::npos) return "";
  const std::size_t from = begin + before.size(), end = tag.find('"', from);
  return end == std::string_view::npos ? "" : std::string(tag.substr(from, end - from));
}

}  // namespace

Aedat4Reader::Aedat4Reader(std::unique_ptr<ByteSource> file, const ReadOptions& options)
    : file_(std::move(file)), faults_(file_->name(), options.strict), opening_faults_(faults_) {
  read_header();
  choose_stream(options.topic);
  describe(options);
  at_ = begin_;
  opening_faults_ = faults_;
}

void Aedat4Reader::read_header() {
  std::vector<std::byte> head(kAedat4Magic.size() + 4);
  const auto fail = [&](const std::string& what) {
    throw InputError(fmt::format("{}: byte {}: {}", file_->name(), kAedat4Magic.size(), what));
  };
  if (file_->read(0, head) != head.size()) fail("ends within the header");
  if (std::string_view(reinterpret_cast<const char*>(head.data()), kAedat4Magic.size()) != kAedat4Magic) {
    throw InputError(fmt::format("{}: is AEDAT of another version; expected 4.0", file_->name()));
  }
  const std::uint64_t size = load<std::uint32_t>(head.data() + kAedat4Magic.size());
  begin_ = head.size() + size;
  if (size > kMostAedat4Header || begin_ > file_->size()) {
    fail(fmt::format("has a header of {} bytes; expected up to the {} of the file, and {}", size, file_->size(),
                     kMostAedat4Header));
  }
  std::vector<std::byte> bytes(4 + static_cast<std::size_t>(size));
  file_->read(kAedat4Magic.size(), bytes);
  const auto header = FlatTable::root(bytes, "IOHE");
  if (!header) fail("has a broken header; expected a FlatBuffer IOHE");
  const auto compression = header->get<std::int32_t>(0);
  switch (compression) {
    case 0: compression_ = Compression::none; break;
    case 1:
    case 2: compression_ = Compression::lz4; break;
    case 3:
    case 4: compression_ = Compression::zstd; break;
    default: fail(fmt::format("has compression {}; expected 0 (none), 1, 2 (LZ4), 3 or 4 (Zstandard)", compression));
  }
  parse_streams(header->text(2));
  end_ = file_->size();
  const auto table = header->get<std::int64_t>(1, -1);
  if (table < 0) return;
  if (static_cast<std::uint64_t>(table) >= begin_ && static_cast<std::uint64_t>(table) < end_ && read_table(table)) {
    end_ = static_cast<std::uint64_t>(table);
  } else {
    packets_.clear();
    starts_.clear();
    for (auto& [id, stream] : streams_) stream.packets = stream.elements = 0;
    faults_.add("no table of packets: the file is cut short or broken", fmt::format("byte {}", table));
  }
}

/// <node name="outInfo"> holds a node for each stream, named by its number; its attributes, and those of the nodes in
/// it, are <attr key="sizeX" type="int">346</attr>.
void Aedat4Reader::parse_streams(std::string_view xml) {
  constexpr std::size_t kMostDepth = 64;
  std::vector<std::string> path;
  for (std::size_t at = xml.find('<'); at != std::string_view::npos; at = xml.find('<', at + 1)) {
    const std::size_t end = xml.find('>', at);
    if (end == std::string_view::npos) break;
    const std::string_view tag = xml.substr(at, end - at);
    if (tag.starts_with("<node") && !tag.ends_with("/") && path.size() < kMostDepth) {
      path.push_back(attribute(tag, "name"));
    } else if (tag.starts_with("</node") && !path.empty()) {
      path.pop_back();
    } else if (tag.starts_with("<attr") && path.size() >= 2 && path[0] == "outInfo") {
      const std::size_t close = xml.find('<', end);
      if (close == std::string_view::npos) break;
      Stream& stream = streams_[number(path[1])];
      const std::string key = attribute(tag, "key"), value(xml.substr(end + 1, close - end - 1));
      stream.fields.emplace(key, value);
      if (key == "typeIdentifier") stream.type = value;
    }
  }
}

std::string Aedat4Reader::Stream::name() const {
  const auto found = fields.find("originalOutputName");
  return found == fields.end() ? type : found->second;
}

/// The table at the end: a FlatBuffer FTAB, compressed like the packets.
bool Aedat4Reader::read_table(std::int64_t offset) {
  const std::uint64_t size = file_->size() - static_cast<std::uint64_t>(offset);
  if (size > kMostAedat4Packet) return false;
  packed_.resize(static_cast<std::size_t>(size));
  if (file_->read(static_cast<std::uint64_t>(offset), packed_) != size || !unpack(packed_)) return false;
  const auto root = FlatTable::root(data_, "FTAB");
  if (!root) return false;
  auto elements = root->elements(0, 4);
  if (!elements) return false;
  for (; elements->size() >= 4; elements = elements->subspan(4)) {
    const auto entry = root->table(*elements);
    if (!entry) return false;
    const auto id = static_cast<std::int32_t>(entry->get<std::uint64_t>(1) & 0xFFFF'FFFF);
    Stream& stream = streams_[id];
    ++stream.packets;
    stream.elements += entry->get<std::int64_t>(2);
    if (stream.type != "EVTS") continue;
    const auto place = static_cast<std::uint64_t>(entry->get<std::int64_t>(0));
    starts_.emplace(id, entry->get<std::int64_t>(3));
    if (place < begin_ + kPacketHeader) return false;
    packets_[id].push_back({place - kPacketHeader, entry->get<std::int64_t>(4)});  // it says where the content begins
  }
  return true;
}

void Aedat4Reader::choose_stream(const std::string& name) {
  std::vector<std::string> names;
  for (const auto& [id, stream] : streams_) {
    if (stream.type == "EVTS" && (name.empty() || name == stream.name() || name == fmt::to_string(id))) {
      stream_ = id;
      return;
    }
    names.push_back(fmt::format("{} {} ({})", id, stream.name(), stream.type));
  }
  throw InputError(fmt::format("{}: has no stream of events{}; found: {}", file_->name(),
                               name.empty() ? "" : " named '" + name + "'",
                               names.empty() ? "nothing" : fmt::format("{}", fmt::join(names, ", "))));
}

void Aedat4Reader::describe(const ReadOptions& options) {
  const Stream& chosen = streams_[stream_];
  const auto field = [&](const std::string& key) {
    const auto found = chosen.fields.find(key);
    return found == chosen.fields.end() ? std::string() : found->second;
  };
  info_.format = "AEDAT 4";
  info_.width = number(field("sizeX"));
  info_.height = number(field("sizeY"));
  if (info_.width <= 0 || info_.height <= 0) {
    info_.width = options.width;
    info_.height = options.height;
  }
  for (const auto& [id, stream] : streams_) {
    info_.topics.push_back(stream.packets > 0 ? fmt::format("{} {} ({}), {} elements in {} packets", id, stream.name(),
                                                            stream.type, stream.elements, stream.packets)
                                              : fmt::format("{} {} ({})", id, stream.name(), stream.type));
  }
  if (const auto packets = packets_.find(stream_); packets != packets_.end()) {
    info_.count = chosen.elements;
    info_.start = starts_[stream_];
    info_.end = packets->second.back().end;
  }
  for (const char* key : {"source", "tsOffset", "compression"}) {
    if (const std::string value = field(key); !value.empty()) info_.metadata.emplace_back(key, value);
  }
}

bool Aedat4Reader::unpack(std::span<const std::byte> packed) {
  switch (compression_) {
    case Compression::none: data_.assign(packed.begin(), packed.end()); return true;
    case Compression::lz4: return decompress_lz4(packed, kMostAedat4Packet, data_);
    case Compression::zstd: return decompress_zstd(packed, kMostAedat4Packet, data_);
  }
  return false;
}

bool Aedat4Reader::read(std::vector<Event>& events) {
  events.clear();
  while (events.empty() && at_ < end_) {
    const std::string place = fmt::format("byte {}", at_);
    std::byte header[kPacketHeader];
    const bool whole = file_->read(at_, header) == kPacketHeader;
    const std::uint64_t size = whole ? load<std::uint32_t>(header + 4) : 0;
    if (!whole || size > kMostAedat4Packet || size > end_ - at_ - kPacketHeader) {
      faults_.add("broken or cut packets, where reading ends", place);
      at_ = end_;
      break;
    }
    const auto stream = load<std::int32_t>(header);
    if (stream == stream_) {
      packed_.resize(static_cast<std::size_t>(size));
      if (file_->read(at_ + kPacketHeader, packed_) != size || !unpack(packed_) || !decode(events)) {
        faults_.add("broken packets of events", place);
      }
    } else if (!streams_.contains(stream)) {
      faults_.add("packets of unknown streams", place);
    }
    at_ += kPacketHeader + size;
  }
  return !events.empty();
}

/// Events are structs of 16 bytes: time, x, y, polarity, padding.
bool Aedat4Reader::decode(std::vector<Event>& events) {
  const auto packet = FlatTable::root(data_, "EVTS");
  if (!packet) return false;
  const auto elements = packet->elements(0, kEvent);
  if (!elements) return false;
  events.resize(elements->size() / kEvent);
  const std::byte* from = elements->data();
  for (Event& event : events) {
    event = {load<std::int64_t>(from), load<std::uint16_t>(from + 8), load<std::uint16_t>(from + 10),
             from[12] != std::byte{0}};
    from += kEvent;
  }
  return true;
}

void Aedat4Reader::seek(std::int64_t t) {
  faults_ = opening_faults_;
  at_ = begin_;
  const auto packets = packets_.find(stream_);
  if (packets == packets_.end() || t <= starts_[stream_]) return;
  at_ = end_;
  for (const Packet& packet : packets->second) {
    if (packet.end >= t) at_ = std::min(at_, packet.offset);
  }
  std::byte header[kPacketHeader];
  const bool is_packet =
      at_ == end_ || (file_->read(at_, header) == kPacketHeader && load<std::int32_t>(header) == stream_);
  if (!is_packet) at_ = begin_;  // a table of another kind, or broken
}

EventFormat aedat4_format() {
  return {"aedat4", "AEDAT 4.0 of iniVation's DV",
          [](const std::string&, std::span<const std::byte> head) {
            return head.size() >= kAnyVersion.size() &&
                   std::equal(kAnyVersion.begin(), kAnyVersion.end(), head.begin(),
                              [](char a, std::byte b) { return static_cast<std::byte>(a) == b; });
          },
          [](const std::string& path, const ReadOptions& options) {
            return std::make_unique<Aedat4Reader>(std::make_unique<FileBytes>(path), options);
          }};
}

}  // namespace evbench
