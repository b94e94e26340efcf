#include "core/process/line_tail.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace evbench {

std::string printable(std::string_view text, std::size_t length) {
  std::string result(text.substr(0, length));
  std::ranges::replace_if(
      result, [](char c) { return (static_cast<unsigned char>(c) < 0x20 && c != '\t') || c == 0x7f; }, '?');
  if (text.size() > length) {
    // Do not cut within a UTF-8 character.
    while (!result.empty() && (static_cast<unsigned char>(text[result.size()]) & 0xC0U) == 0x80U) result.pop_back();
    result += "...";
  }
  return result;
}

void LineTail::add(std::string_view part) {
  while (!part.empty()) {
    const std::size_t end = std::min(part.find('\n'), part.size());
    // One byte more than is shown, so that printable() marks the cut.
    current_ += part.substr(0, std::min(end, kLength + 1 - std::min(current_.size(), kLength + 1)));
    if (end == part.size()) return;
    part.remove_prefix(end + 1);
    lines_.push_back(std::move(current_));
    current_.clear();
    if (lines_.size() > kLines) {
      lines_.pop_front();
      ++dropped_;
    }
  }
}

std::string LineTail::text(std::string_view indent) const {
  std::string result;
  const std::size_t first = lines_.size() == kLines && !current_.empty() ? 1 : 0;
  const std::size_t dropped = dropped_ + first;
  if (dropped > 0) result += fmt::format("\n{}({} lines before these)", indent, dropped);
  for (std::size_t i = first; i < lines_.size(); ++i) {
    result += fmt::format("\n{}{}", indent, printable(lines_[i], kLength));
  }
  if (!current_.empty()) result += fmt::format("\n{}{}", indent, printable(current_, kLength));
  return result;
}

}  // namespace evbench
