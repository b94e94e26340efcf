#pragma once

#include "core/events/bytes/event_decoder.hpp"
#include "core/events/text/text_layout.hpp"

namespace evbench {

/// Lines of text, an event each. Times are rounded to microseconds. Blank lines and comments (# or %) are skipped;
/// lines that are no event, or longer than 64 KiB, are faults.
class EventTextDecoder final : public EventDecoder {
 public:
  explicit EventTextDecoder(TextLayout layout) : layout_(std::move(layout)), line_(layout_.lines) {}
  Progress decode(std::span<const std::byte> in, std::uint64_t offset, std::span<Event> out, Faults& faults) override;
  /// The last line may lack its line break.
  std::size_t finish(std::span<const std::byte> in, std::uint64_t offset, std::span<Event> out,
                     Faults& faults) override;
  void reset() override;

 private:
  bool parse_common(const char*& at, Event& event) const;
  bool parse_any(std::string_view line, Event& event) const;
  bool contradicts_guess(std::string_view time) const;
  bool has_contradicting_time(std::string_view line) const;

  TextLayout layout_;
  std::int64_t line_;
  bool in_long_line_ = false;
};

}  // namespace evbench
