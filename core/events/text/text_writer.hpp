#pragma once

#include <fmt/format.h>

#include <string>

#include "core/events/writer.hpp"

namespace evbench {

/// The Event-Camera Dataset's events.txt: `t x y p`, seconds with six decimals, polarity 0 or 1. Comments before the
/// events state this, and the sensor's size if it is known.
class TextWriter : public EventWriter {
 public:
  /// `name`: the file's, for messages.
  TextWriter(const std::string& path, std::string name, const RecordingHeader& header = {});
  ~TextWriter() override;
  TextWriter(const TextWriter&) = delete;
  TextWriter& operator=(const TextWriter&) = delete;

  void write(std::span<const Event> events) override;
  void finish() override;

 private:
  void put_buffer();
  [[noreturn]] void fail() const;

  std::string name_;
  int file_ = -1;
  fmt::memory_buffer buffer_;
};

}  // namespace evbench
