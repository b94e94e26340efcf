#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/events/formats/zip_archive.hpp"
#include "core/support/byte_source.hpp"

namespace evbench {

/// A recording of the Event-Camera Dataset: events and what lies beside them (calib.txt, groundtruth.txt, images/), in
/// a folder or a .zip.
class EcdFiles {
 public:
  /// `path`: a folder or .zip with events.txt, or a file of events of any name. Throws InputError when there is none.
  explicit EcdFiles(const std::string& path);

  std::unique_ptr<ByteSource> open_events() const;

  /// The dataset's files that are there, but for the events.
  const std::vector<std::string>& others() const { return others_; }
  bool has(const std::string& name) const;

  /// Calls a function that reads a file by its path, with that of one of others(); what is in a .zip is unpacked into
  /// memory, up to 64 MiB.
  void read(const std::string& name, const std::function<void(const std::string& path)>& read) const;

  /// Width and height of the first picture in images/; none where there is no PNG.
  std::optional<std::pair<int, int>> picture_size() const;

 private:
  bool exists(const std::string& name) const;
  std::unique_ptr<ByteSource> open(const std::string& file) const;
  std::string first_picture() const;

  std::optional<ZipArchive> archive_;
  std::string folder_;  ///< in the archive, or the file system; with the slash
  std::string events_;  ///< likewise
  std::vector<std::string> others_;
};

}  // namespace evbench
