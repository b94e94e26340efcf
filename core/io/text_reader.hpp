#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace evbench {

/// Reads a text file (gzip or not) record by record. A record is a line that is neither blank nor a comment (# or %),
/// split into columns at blanks and tabs, or at a comma or semicolon with optional blanks. Every error is an InputError
/// with file and line.
class TextReader {
 public:
  /// "-" is the standard input. Waits for data of a pipe; after a second a message on the standard error says so.
  /// Throws if the file can't be opened.
  explicit TextReader(const std::string& path);
  ~TextReader();
  TextReader(const TextReader&) = delete;
  TextReader& operator=(const TextReader&) = delete;

  /// Reads the next record; false at the end of the file. Throws if the file is damaged (truncated gzip, a line of more
  /// than 64 KiB, a NUL byte).
  bool next();

  /// Empty before the first record and after the last one.
  std::span<const std::string_view> columns() const { return columns_; }
  /// The record's line, and the comment directly before it (empty: none).
  const std::string& text() const { return current_; }
  const std::string& comment() const { return comment_; }
  std::int64_t line() const { return line_; }

  const std::string& path() const { return path_; }

  /// Throws unless the record has exactly `count` columns; `what` names them ("id t x y").
  void expect_columns(std::size_t count, const char* what) const;

  /// A column as a finite number; throws for anything else. `what` names it in the message.
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
