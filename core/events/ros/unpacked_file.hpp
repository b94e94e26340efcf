#pragma once

#include <cstdint>
#include <string>

namespace evbench {

/// What a file compressed by zstd holds, as a file in the folder for temporary files that disappears with the object:
/// for libraries that read by path. Once one has opened it, the object is no longer needed.
class UnpackedFile {
 public:
  /// Throws InputError when the file can't be read, is broken or cut short, or holds more than kMostRatio times its
  /// size (a bomb), when there is no room for it, and when the program is asked to end.
  explicit UnpackedFile(const std::string& packed);
  ~UnpackedFile();
  UnpackedFile(const UnpackedFile&) = delete;
  UnpackedFile& operator=(const UnpackedFile&) = delete;

  static constexpr std::uint64_t kMostRatio = 200;  ///< beyond 1 MiB; recordings have some 2 to 20

  const std::string& path() const { return path_; }

 private:
  std::string path_;
};

}  // namespace evbench
