#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "core/events/bytes/zip_archive.hpp"
#include "core/io/byte_source.hpp"

namespace evbench {

/// A recording's folder, or a .zip of one: the file with the events, and the files next to it.
class RecordingFiles {
 public:
  /// `path`: a folder, a .zip with an events.txt, or a file of events of any name. The recording's folder is the one
  /// with events/ in it for DSEC's events/left/events.h5, and the one with left/ in it for left/events.h5. Throws
  /// InputError for a .zip without an events.txt, or with several.
  explicit RecordingFiles(const std::string& path);

  /// Path of the events, or of the .zip that has them; empty: a folder without events. In a folder it is the first of
  /// events.evb (a native copy), events.txt, and the names of DSEC, TUM-VIE, M3ED, MVSEC and EDS. Throws InputError for
  /// a folder with two of the same kind.
  std::string events() const;
  /// The events; unpacked if their file is compressed.
  std::unique_ptr<ByteSource> open_events() const;

  /// Names are relative to the folder.
  bool has(const std::string& name) const;
  /// The names that fit a pattern, sorted: `*` matches anything but a slash, and only in the last part.
  std::vector<std::string> matching(const std::string& pattern) const;
  std::string path(const std::string& name) const;

  std::unique_ptr<ByteSource> open(const std::string& name) const;

  /// Calls a function that reads a file by its path; what is in a .zip is unpacked into memory, up to 64 MiB.
  void read(const std::string& name, const std::function<void(const std::string& path)>& read) const;

  /// The result of such a function.
  template <class F>
  auto get(const std::string& name, F f) const {
    std::optional<std::invoke_result_t<F, const std::string&>> result;
    read(name, [&](const std::string& path) { result.emplace(f(path)); });
    return std::move(*result);
  }

 private:
  std::optional<ZipArchive> archive_;
  std::string folder_;  ///< in the archive or the file system; ends with a slash
  std::string events_;  ///< likewise; empty: events() searches for them
};

}  // namespace evbench
