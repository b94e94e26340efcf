#include "core/events/ros/unpacked_file.hpp"

#include <fmt/format.h>
#include <zstd.h>

#include <memory>
#include <vector>

#include "core/io/byte_source.hpp"
#include "core/support/error.hpp"
#include "core/support/interruption.hpp"

namespace evbench {
namespace {

void unpack(FileBytes& file, TemporaryFile& content) {
  const std::unique_ptr<ZSTD_DCtx, decltype(&ZSTD_freeDCtx)> context(ZSTD_createDCtx(), ZSTD_freeDCtx);
  ZSTD_DCtx_setParameter(context.get(), ZSTD_d_windowLogMax, 27);
  std::vector<std::byte> in(1 << 20), out(1 << 20);
  const std::uint64_t most = (1 << 20) + UnpackedFile::kMostRatio * file.size();
  std::uint64_t at = 0, made = 0;
  std::size_t missing = 1;  // 0 at the end of a frame
  while (at < file.size()) {
    ZSTD_inBuffer source{in.data(), file.read(at, in), 0};
    if (source.size == 0) break;
    at += source.size;
    bool full = true;  // more may come without further input
    while (source.pos < source.size || full) {
      check_interruption();
      ZSTD_outBuffer target{out.data(), out.size(), 0};
      missing = ZSTD_decompressStream(context.get(), &target, &source);
      made += target.pos;
      if (ZSTD_isError(missing)) {
        throw InputError(fmt::format("{}: is broken: {}", file.name(), ZSTD_getErrorName(missing)));
      }
      if (made > most) {
        throw InputError(fmt::format("{}: holds more than {} bytes; expected at most {} times its size", file.name(),
                                     most, UnpackedFile::kMostRatio));
      }
      content.write(std::span(out).first(target.pos));
      full = target.pos == target.size && missing != 0;
    }
  }
  if (missing != 0) throw InputError(fmt::format("{}: is cut short", file.name()));
}

}  // namespace

UnpackedFile::UnpackedFile(const std::string& packed) {
  FileBytes file(packed);
  unpack(file, content_);
}

}  // namespace evbench
