#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/support/error.hpp"

namespace evbench {

/// Writes a whole file atomically as a PartFile: readers see the old or the new content, never a part. Pipes and
/// devices are written to directly. Throws InputError (folder missing, no permission, disk full) and then leaves
/// nothing behind.
void write_file(const std::string& path, std::string_view content);

/// Checks the outputs of a command before it starts. Throws InputError for an output (a file or a non-empty folder)
/// that exists, unless `force` is set; for an output that is also read; and for two equal outputs. Empty names are
/// ignored; empty folders, pipes and devices may exist.
void check_outputs(const std::vector<std::string>& outputs, const std::vector<std::string>& read, bool force);

/// Another process is writing to the folder.
class FolderTaken : public InputError {
 public:
  using InputError::InputError;
};

/// A folder that appears under its name only when it is complete. Files are written into a temporary folder next to it
/// (name + ".evbench.part"); commit() renames it and replaces an older folder of that name, or the target of a symbolic
/// link of that name. The folder is locked: a second writer gets FolderTaken. The lock ends with the process and its
/// forks, however they end. Without commit() the temporary folder is removed with the object; leftovers of a killed
/// program are removed by the next writer. After a power cut the folder is complete or does not exist.
class AtomicFolder {
 public:
  explicit AtomicFolder(const std::string& path);
  ~AtomicFolder();
  AtomicFolder(const AtomicFolder&) = delete;
  AtomicFolder& operator=(const AtomicFolder&) = delete;

  /// Is any process, including this one, writing to this folder?
  static bool is_taken(const std::string& path);

  /// Removes the leftovers of a killed writer of this folder, and restores the folder that it was replacing.
  static void clear_leftovers(const std::string& path);

  /// Writes a file into the folder; throws InputError on failure.
  void write(const std::string& name, std::string_view content) const;

  /// The temporary folder, for files too large for write().
  const std::string& part() const { return part_; }

  /// Removes everything written so far.
  void clear() const;

  void commit();

 private:
  std::string path_, target_, part_, old_, lock_path_;
  int lock_ = -1;
};

}  // namespace evbench
