#pragma once

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <span>
#include <string>

#include "core/events/formats.hpp"
#include "core/events/testing/fuzz_reader.hpp"

namespace evbench {

/// A new file for each input: libraries keep the state of files that they have open.
class FuzzFile {
 public:
  FuzzFile(const std::uint8_t* data, std::size_t size)
      : path_((std::filesystem::temp_directory_path() / fmt::format("evbench_fuzz_{}", ::getpid())).string()) {
    std::filesystem::remove(path_);
    std::ofstream(path_, std::ios::binary)
        .write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
  }
  ~FuzzFile() { std::filesystem::remove(path_); }
  FuzzFile(const FuzzFile&) = delete;
  FuzzFile& operator=(const FuzzFile&) = delete;

  const std::string& path() const { return path_; }

 private:
  std::string path_;
};

/// Reads any bytes as a file of a format that a library reads by its path; skipped unless the format recognises them.
inline int fuzz_file(const std::uint8_t* data, std::size_t size, const EventFormat& format) {
  constexpr std::size_t kHead = 1 << 16;
  const auto head = std::as_bytes(std::span(data, std::min(size, kHead)));
  if (head.empty() || !format.recognises("fuzz", head)) return 0;
  const FuzzFile file(data, size);
  for (const char* const columns : {"", "x,y,t_us,p"}) {
    if (*columns != '\0' && !format.has_columns) continue;
    ReadOptions options;
    options.columns = columns;
    try {
      exercise(*format.open(file.path(), options));
    } catch (const InputError&) {
    }
  }
  return 0;
}

}  // namespace evbench
