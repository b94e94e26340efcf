#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "core/events/formats.hpp"
#include "core/events/reader.hpp"
#include "core/io/byte_source.hpp"

namespace evbench {

/// AEDAT 4.0 of iniVation's DV. A file has packets of several streams (events, frames, IMU, triggers), each a
/// FlatBuffer, plain or compressed with LZ4 or Zstandard; an XML text that describes the streams; and an optional table
/// of all packets at the end.
/// https://docs.inivation.com/software/software-advanced-usage/file-formats/aedat-4.0.html
class Aedat4Reader : public EventReader {
 public:
  Aedat4Reader(std::unique_ptr<ByteSource> file, const ReadOptions& options);

  const StreamInfo& info() const override { return info_; }
  bool read(std::vector<Event>& events) override;
  void seek(std::int64_t t) override;
  const Faults& faults() const override { return faults_; }

 private:
  enum class Compression { none, lz4, zstd };
  struct Stream {
    std::string type;                           ///< four characters, e.g. EVTS
    std::map<std::string, std::string> fields;  ///< keys of its XML node and of "info" below it
    std::int64_t packets = 0, elements = 0;     ///< from the table at the end
    std::string name() const;
  };
  struct Packet {
    std::uint64_t offset = 0;
    std::int64_t end = 0;  ///< [µs] time of its last event
  };

  void read_header();
  void parse_streams(std::string_view xml);
  bool read_table(std::int64_t offset);
  void choose_stream(const std::string& name);
  void describe(const ReadOptions& options);
  bool unpack(std::span<const std::byte> packed);
  bool decode(std::vector<Event>& events);

  std::unique_ptr<ByteSource> file_;
  Faults faults_, opening_faults_;
  StreamInfo info_;
  Compression compression_ = Compression::none;
  std::map<std::int32_t, Stream> streams_;
  std::map<std::int32_t, std::vector<Packet>> packets_;  ///< by stream; of event streams only
  std::map<std::int32_t, std::int64_t> starts_;          ///< [µs] first event of the stream
  std::int32_t stream_ = 0;
  std::uint64_t begin_ = 0, end_ = 0;  ///< byte range of the packets
  std::uint64_t at_ = 0;
  std::vector<std::byte> packed_, data_;
};

EventFormat aedat4_format();

}  // namespace evbench
