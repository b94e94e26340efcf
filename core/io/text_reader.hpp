#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace evbench {

/// Reads a text file, gzip or not, record by record: the columns of each line that is neither blank nor a comment (# or
/// %). Between columns are blanks and tabs, or a comma or semicolon with or without them. Every error is an InputError
/// that names the file and the line.
class TextReader {
 public:
  /// "-" is the standard input. Throws when the file can't be opened. Waits for a pipe, and says so on the standard
  /// error after a second.
  explicit TextReader(const std::string& path);
  ~TextReader();
  TextReader(const TextReader&) = delete;
  TextReader& operator=(const TextReader&) = delete;

  /// The next record; false at the end of the file. Throws when the file is damaged (truncated gzip, a line of more
  /// than 64 KiB, a NUL byte).
  bool next();

  /// Empty before the first record and behind the last one.
  std::span<const std::string_view> columns() const { return columns_; }
  /// The record's line, and the comment that stands directly before it; empty: none.
  const std::string& text() const { return current_; }
  const std::string& comment() const { return comment_; }
  std::int64_t line() const { return line_; }

  const std::string& path() const { return path_; }

  /// Throws unless the record has exactly `count` columns; `what` names them ("id t x y").
  void expect_columns(std::size_t count, const char* what) const;

  /// Column as a finite number; throws for anything else. `what` names it in the message.
  double number(std::size_t column, const char* what) const;
  std::int64_t integer(std::size_t column, const char* what) const;

  /// Throws an InputError that begins with the place.
  [[noreturn]] void fail(const std::string& message) const;

  /// The path and line: "tracks.txt:12".
  std::string place() const;

 private:
  std::string path_;
  void* file_ = nullptr;  // gzFile
  std::vector<char> buffer_;
  std::size_t begin_ = 0, end_ = 0;
  bool at_end_ = false;
  std::string current_, comment_;
  std::vector<std::string_view> columns_;
  std::int64_t line_ = 0;

  bool read_line();
  void split();
  void fill();
};

}  // namespace evbench
