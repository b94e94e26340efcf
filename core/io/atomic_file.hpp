#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/support/error.hpp"

namespace evbench {

/// Writes a whole file as a PartFile: readers see the old content or the new, never a half; a pipe or device is written
/// to. Throws InputError (folder missing, no permission, disk full) and leaves nothing behind.
void write_file(const std::string& path, std::string_view content);

/// What a command asks before it works: throws InputError for an output, a file or a folder of files, that is there
/// already, unless it is told to replace it; for one that is among the files that are read, in any case; and for two
/// that are the same. Empty names are none; empty folders, pipes and devices hold nothing that could be lost.
void check_outputs(const std::vector<std::string>& outputs, const std::vector<std::string>& read, bool force);

/// Another writer has the folder.
class FolderTaken : public InputError {
 public:
  using InputError::InputError;
};

/// A folder that appears under its name only when it is complete: files are written into a temporary folder beside it
/// (name + ".evbench.part"), commit() renames it, replacing an older folder of that name, or the one that a symbolic
/// link of that name leads to. Locked while it exists: a second writer of the same folder gets FolderTaken. The lock
/// ends with the process and those that it forks, however they end. Not committed, it disappears with the object; what
/// a killed program left, the next writer removes. After a power cut it is there whole or not at all.
class AtomicFolder {
 public:
  explicit AtomicFolder(const std::string& path);
  ~AtomicFolder();
  AtomicFolder(const AtomicFolder&) = delete;
  AtomicFolder& operator=(const AtomicFolder&) = delete;

  /// Is somebody writing to this folder, this process included?
  static bool is_taken(const std::string& path);

  /// Clears away what a killed writer of this folder left beside it, and puts back what that was replacing.
  static void clear_leftovers(const std::string& path);

  /// Writes a file of this name into the folder; throws InputError when it can't.
  void write(const std::string& name, std::string_view content) const;

  /// The temporary folder, for files that are too big for write().
  const std::string& part() const { return part_; }

  /// Removes what has been written so far.
  void clear() const;

  void commit();

 private:
  std::string path_, target_, part_, old_, lock_path_;
  int lock_ = -1;
};

}  // namespace evbench
