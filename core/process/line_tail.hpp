#pragma once

#include <cstddef>
#include <deque>
#include <string>
#include <string_view>

namespace evbench {

/// Keeps the last lines of a text that arrives in parts, in bounded memory.
class LineTail {
 public:
  static constexpr std::size_t kLines = 20, kLength = 500;  ///< kept lines, and kept bytes of each

  void add(std::string_view part);

  bool empty() const { return lines_.empty() && current_.empty(); }

  /// The kept lines, each preceded by a newline and `indent`; unprintable characters are shown as "?". If lines were
  /// dropped, the first line gives their number.
  std::string text(std::string_view indent) const;

 private:
  std::deque<std::string> lines_;
  std::string current_;      ///< the unfinished line
  std::size_t dropped_ = 0;  ///< lines
};

/// The beginning of a text for messages: at most `length` bytes, unprintable characters shown as "?".
std::string printable(std::string_view text, std::size_t length);

}  // namespace evbench
