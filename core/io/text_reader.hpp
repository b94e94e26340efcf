#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace evbench {

/// Reads a text file, gzip or not, record by record: the columns of each line that is neither blank nor a comment (#).
/// Every error is an InputError that names the file and the line.
class TextReader {
 public:
  /// `separators`: the characters between columns. Throws when the file can't be opened. Waits for a pipe, and
  /// says so on the standard error after a second.
  explicit TextReader(const std::string& path, std::string_view separators = " \t");
  ~TextReader();
  TextReader(const TextReader&) = delete;
  TextReader& operator=(const TextReader&) = delete;

  /// The next record; false at the end of the file. Throws when the file is damaged (truncated gzip, a line of more
  /// than 64 KiB, a NUL byte).
  bool next();

  std::span<const std::string_view> columns() const { return columns_; }
  std::int64_t line() const { return line_; }

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
  std::string separators_;
  void* file_ = nullptr;  // gzFile
  std::vector<char> buffer_;
  std::size_t begin_ = 0, end_ = 0;
  bool at_end_ = false;
  std::string current_;
  std::vector<std::string_view> columns_;
  std::int64_t line_ = 0;

  bool read_line();
  void fill();
};

}  // namespace evbench
