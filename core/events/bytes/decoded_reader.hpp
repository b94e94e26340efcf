#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/events/bytes/event_decoder.hpp"
#include "core/events/reader.hpp"
#include "core/io/byte_source.hpp"

namespace evbench {

/// Reads a file that consists of a header and a stream for a decoder. Seeking back reads from the beginning.
class DecodedReader : public EventReader {
 public:
  /// `begin`: offset of the stream, after the header.
  DecodedReader(std::unique_ptr<ByteSource> source, std::uint64_t begin, std::unique_ptr<EventDecoder> decoder,
                StreamInfo info, const ReadOptions& options);

  const StreamInfo& info() const override { return info_; }
  bool read(std::vector<Event>& events) override;
  void seek(std::int64_t t) override;
  const Faults& faults() const override { return faults_; }

 private:
  bool fill();
  std::span<const std::byte> rest() const { return std::span(buffer_).subspan(used_, filled_ - used_); }

  std::unique_ptr<ByteSource> source_;
  std::uint64_t begin_;
  std::unique_ptr<EventDecoder> decoder_;
  StreamInfo info_;
  bool strict_;
  Faults faults_;

  std::vector<std::byte> buffer_;
  std::size_t used_ = 0, filled_ = 0;  ///< positions in the buffer
  std::uint64_t offset_;               ///< position of the buffer's end in the source
  bool ended_ = false;
};

}  // namespace evbench
