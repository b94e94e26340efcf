#pragma once

#include <cstdint>
#include <string>

#include "core/io/temporary_file.hpp"

namespace evbench {

/// What a file compressed by zstd holds, as a TemporaryFile: for libraries that read by path. Once one has opened it,
/// the object is no longer needed.
class UnpackedFile {
 public:
  /// Throws InputError when the file can't be read, is broken or cut short, or holds more than kMostRatio times its
  /// size (a bomb), when there is no room for it, and when the program is asked to end.
  explicit UnpackedFile(const std::string& packed);

  static constexpr std::uint64_t kMostRatio = 200;  ///< beyond 1 MiB; recordings have some 2 to 20

  const std::string& path() const { return content_.path(); }

 private:
  TemporaryFile content_;
};

}  // namespace evbench
