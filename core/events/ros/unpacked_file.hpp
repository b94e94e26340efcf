#pragma once

#include <cstdint>
#include <string>

#include "core/io/temporary_file.hpp"

namespace evbench {

/// The content of a file compressed by zstd, as a TemporaryFile: for libraries that read by path. Once the library has
/// opened it, the object is no longer needed.
class UnpackedFile {
 public:
  /// Throws InputError if the file can't be read, is broken or cut short, or contains more than kMostRatio times its
  /// size (a bomb); if there is no room for it; and if the program is interrupted.
  explicit UnpackedFile(const std::string& packed);

  static constexpr std::uint64_t kMostRatio = 200;  ///< beyond 1 MiB; recordings have some 2 to 20

  const std::string& path() const { return content_.path(); }

 private:
  TemporaryFile content_;
};

}  // namespace evbench
