#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/events/reader.hpp"

namespace evbench {

/// A file format. Each of the folders here has a family of formats.
struct EventFormat {
  std::string name;         ///< e.g. "raw"
  std::string description;  ///< a line
  /// Recognises a file by its beginning (up to 64 KiB; empty for a folder), not by its name.
  std::function<bool(const std::string& path, std::span<const std::byte> head)> recognises;
  std::function<std::unique_ptr<EventReader>(const std::string& path, const ReadOptions& options)> open;
  bool has_columns = false;  ///< ReadOptions::columns may name them
};

/// All formats, in the order in which they are tried (all_formats.cpp).
const std::vector<EventFormat>& event_formats();

/// Opens a recording, a file or a folder (recording_files.hpp), by its content, with the calibration and ground truth
/// of the files next to it. Throws InputError if no format recognises it or it is broken.
std::unique_ptr<EventReader> open_events(const std::string& path, const ReadOptions& options = {});

/// Is there a file of events at the path, or in the folder?
bool holds_events(const std::string& path);

/// The files with the events of such a path, sorted: one, or several for formats that are folders.
std::vector<std::string> files_of_events(const std::string& path);

}  // namespace evbench
