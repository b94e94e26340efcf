#pragma once

#include <cstddef>
#include <deque>
#include <string>
#include <string_view>

namespace evbench {

/// The last lines of a text that comes in parts, however long it gets.
class LineTail {
 public:
  static constexpr std::size_t kLines = 20, kLength = 500;  ///< kept: lines, and bytes of each

  void add(std::string_view part);

  bool empty() const { return lines_.empty() && current_.empty(); }

  /// The lines kept, each after `indent` and with a newline before it; what can't be printed is shown as "?".
  /// Of lines that are not kept, a first line tells the number.
  std::string text(std::string_view indent) const;

 private:
  std::deque<std::string> lines_;
  std::string current_;      ///< has no newline yet
  std::size_t dropped_ = 0;  ///< lines
};

/// A text's beginning, for messages: at most `length` bytes, what can't be printed shown as "?".
std::string printable(std::string_view text, std::size_t length);

}  // namespace evbench
