#include "core/io/text_reader.hpp"

#include <fmt/format.h>
#include <unistd.h>
#include <zlib.h>

#include <charconv>
#include <cmath>
#include <cstring>
#include <filesystem>

#include "core/io/open_to_read.hpp"
#include "core/support/interruption.hpp"

namespace evbench {
namespace {

constexpr std::size_t kBufferSize = std::size_t{1} << 18;
constexpr std::size_t kLongestLine = std::size_t{1} << 16;
constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";

gzFile handle(void* file) { return static_cast<gzFile>(file); }

}  // namespace

TextReader::TextReader(const std::string& path) : path_(path), buffer_(kBufferSize) {
  std::error_code ignored;
  if (path != "-" && !std::filesystem::exists(path, ignored)) throw InputError(fmt::format("{}: no such file", path));
  if (std::filesystem::is_directory(path, ignored)) {
    throw InputError(fmt::format("{}: is a folder; expected a text file", path));
  }
  const int file = open_to_read(path);
  if (file < 0) {
    const int error = errno;
    check_interruption();  // opening may have waited for a pipe
    throw InputError(fmt::format("{}: can't be opened: {}", path, std::strerror(error)));
  }
  file_ = gzdopen(file, "rb");
  if (file_ == nullptr) {
    ::close(file);
    throw InputError(fmt::format("{}: can't be opened: the memory is not enough", path));
  }
}

TextReader::~TextReader() { gzclose(handle(file_)); }

void TextReader::fill() {
  const int count = gzread(handle(file_), buffer_.data(), static_cast<unsigned>(buffer_.size()));
  int code = Z_OK;
  const char* message = gzerror(handle(file_), &code);
  check_interruption();  // a signal may have ended the reading
  if (count < 0 || (code != Z_OK && code != Z_STREAM_END)) {
    fail(code == Z_BUF_ERROR ? "the gzip data end too early: the file is truncated"
                             : fmt::format("can't be read on: {}", message));
  }
  begin_ = 0;
  end_ = static_cast<std::size_t>(count);
  at_end_ = count == 0;
}

bool TextReader::read_line() {
  current_.clear();
  while (true) {
    if (begin_ == end_) {
      fill();
      if (at_end_) return !current_.empty();
    }
    const char* const from = buffer_.data() + begin_;
    const auto* const newline = static_cast<const char*>(std::memchr(from, '\n', end_ - begin_));
    const std::size_t length = newline == nullptr ? end_ - begin_ : static_cast<std::size_t>(newline - from);
    if (current_.size() + length > kLongestLine) fail("the line is longer than 64 KiB; expected a text file");
    current_.append(from, length);
    begin_ += length;
    if (newline != nullptr) {
      ++begin_;
      return true;
    }
  }
}

bool TextReader::next() {
  comment_.clear();
  while (true) {
    ++line_;
    columns_.clear();
    if (!read_line()) return false;
    if (current_.find('\0') != std::string::npos) fail("has a NUL byte; expected a text file");
    if (line_ == 1 && current_.starts_with(kByteOrderMark)) current_.erase(0, kByteOrderMark.size());
    if (!current_.empty() && current_.back() == '\r') current_.pop_back();
    split();
    if (columns_.empty()) {
      comment_.clear();
    } else if (columns_.front().starts_with('#') || columns_.front().starts_with('%')) {
      comment_ = current_;
    } else {
      return true;
    }
  }
}

/// A separator after the last column does not start another one.
void TextReader::split() {
  constexpr std::string_view kBlanks = " \t", kSeparators = " \t,;";
  columns_.clear();
  const std::string_view text = current_;
  std::size_t at = text.find_first_not_of(kBlanks);
  while (at != std::string_view::npos) {
    const std::size_t stop = std::min(text.find_first_of(kSeparators, at), text.size());
    columns_.push_back(text.substr(at, stop - at));
    at = text.find_first_not_of(kBlanks, stop);
    if (at != std::string_view::npos && (text[at] == ',' || text[at] == ';')) {
      at = text.find_first_not_of(kBlanks, at + 1);
    }
  }
}

void TextReader::expect_columns(std::size_t count, const char* what) const {
  if (columns_.size() != count) {
    fail(fmt::format("has {} columns; expected {} ({})", columns_.size(), count, what));
  }
}

double TextReader::number(std::size_t column, const char* what) const {
  std::string_view text = columns_[column];
  if (text.starts_with('+')) text.remove_prefix(1);
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) {
    fail(fmt::format("{} is \"{}\"; expected a finite number", what, text));
  }
  return value;
}

std::int64_t TextReader::integer(std::size_t column, const char* what) const {
  const std::string_view text = columns_[column];
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) {
    fail(fmt::format("{} is \"{}\"; expected an integer", what, text));
  }
  return value;
}

void TextReader::fail(const std::string& message) const { throw InputError(fmt::format("{}: {}", place(), message)); }

std::string TextReader::place() const { return fmt::format("{}:{}", path_, line_); }

}  // namespace evbench
