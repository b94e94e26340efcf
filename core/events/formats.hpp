#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/events/reader.hpp"

namespace evbench {

/// A file format; the folders beside this file have a family of them each.
struct EventFormat {
  std::string name;         ///< e.g. "raw"
  std::string description;  ///< a line
  /// By the beginning of the file (up to 64 KiB; empty for a folder), not by its name.
  std::function<bool(const std::string& path, std::span<const std::byte> head)> recognises;
  std::function<std::unique_ptr<EventReader>(const std::string& path, const ReadOptions& options)> open;
  bool has_columns = false;  ///< that ReadOptions::columns may name
};

/// All of them, in the order in which they are asked (all_formats.cpp).
const std::vector<EventFormat>& event_formats();

/// Opens a recording, a file or a folder (recording_files.hpp), by what it contains, with the calibration and ground
/// truth that lie beside it. Throws InputError when no format recognises it, or it is broken.
std::unique_ptr<EventReader> open_events(const std::string& path, const ReadOptions& options = {});

/// Is there a file of events at the path, or in the folder?
bool holds_events(const std::string& path);

/// The files that hold the events of such a path, sorted: one, but for formats that are folders.
std::vector<std::string> files_of_events(const std::string& path);

}  // namespace evbench
