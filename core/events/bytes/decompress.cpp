#include "core/events/bytes/decompress.hpp"

#include <bzlib.h>
#include <lz4frame.h>
#include <zstd.h>

#include <algorithm>
#include <memory>

namespace evbench {
namespace {

/// Where decompressed bytes go: a vector that grows, with some room at its end.
class Output {
 public:
  Output(std::vector<std::byte>& bytes, std::size_t in_size, std::size_t most) : bytes_(bytes), most_(most) {
    bytes_.resize(std::min(std::max(bytes_.capacity(), 4 * in_size), most));
  }
  /// Empty when there is no more room to be had.
  std::span<std::byte> room() {
    if (used_ == bytes_.size()) bytes_.resize(std::min(std::max<std::size_t>(2 * used_, 1 << 16), most_));
    return std::span(bytes_).subspan(used_);
  }
  void add(std::size_t count) { used_ += count; }
  bool finish(bool ok) {
    bytes_.resize(ok ? used_ : 0);
    return ok;
  }

 private:
  std::vector<std::byte>& bytes_;
  std::size_t most_, used_ = 0;
};

}  // namespace

bool decompress_lz4(std::span<const std::byte> in, std::size_t most, std::vector<std::byte>& out) {
  LZ4F_dctx* raw = nullptr;
  if (LZ4F_isError(LZ4F_createDecompressionContext(&raw, LZ4F_VERSION))) return false;
  const std::unique_ptr<LZ4F_dctx, decltype(&LZ4F_freeDecompressionContext)> context(raw,
                                                                                     LZ4F_freeDecompressionContext);
  Output output(out, in.size(), most);
  std::size_t missing = 1;  // 0 at the end of a frame
  while (!in.empty() || missing != 0) {
    const auto room = output.room();
    std::size_t made = room.size(), taken = in.size();
    missing = LZ4F_decompress(context.get(), room.data(), &made, in.data(), &taken, nullptr);
    if (LZ4F_isError(missing) || (made == 0 && taken == 0)) return output.finish(false);
    output.add(made);
    in = in.subspan(taken);
  }
  return output.finish(true);
}

bool decompress_zstd(std::span<const std::byte> in, std::size_t most, std::vector<std::byte>& out) {
  const std::unique_ptr<ZSTD_DCtx, decltype(&ZSTD_freeDCtx)> context(ZSTD_createDCtx(), ZSTD_freeDCtx);
  ZSTD_DCtx_setParameter(context.get(), ZSTD_d_windowLogMax, 27);
  Output output(out, in.size(), most);
  ZSTD_inBuffer source{in.data(), in.size(), 0};
  std::size_t missing = 1;  // 0 at the end of a frame
  while (source.pos < source.size || missing != 0) {
    const auto room = output.room();
    ZSTD_outBuffer target{room.data(), room.size(), 0};
    const std::size_t before = source.pos;
    missing = ZSTD_decompressStream(context.get(), &target, &source);
    if (ZSTD_isError(missing) || (target.pos == 0 && source.pos == before)) return output.finish(false);
    output.add(target.pos);
  }
  return output.finish(true);
}

bool decompress_bzip2(std::span<const std::byte> in, std::size_t most, std::vector<std::byte>& out) {
  constexpr std::size_t kMostAtOnce = 1u << 30;  // the library counts in 32 bits
  bz_stream stream{};
  if (BZ2_bzDecompressInit(&stream, 0, 0) != BZ_OK) return false;
  const std::unique_ptr<bz_stream, decltype(&BZ2_bzDecompressEnd)> end(&stream, BZ2_bzDecompressEnd);
  Output output(out, in.size(), most);
  if (in.size() > kMostAtOnce) return output.finish(false);
  stream.next_in = const_cast<char*>(reinterpret_cast<const char*>(in.data()));
  stream.avail_in = static_cast<unsigned>(in.size());
  for (;;) {
    const auto room = output.room();
    const auto length = static_cast<unsigned>(std::min(room.size(), kMostAtOnce));
    const unsigned before = stream.avail_in;
    stream.next_out = reinterpret_cast<char*>(room.data());
    stream.avail_out = length;
    const int result = BZ2_bzDecompress(&stream);
    const unsigned made = length - stream.avail_out;
    output.add(made);
    if (result == BZ_STREAM_END) return output.finish(true);
    if (result != BZ_OK || (made == 0 && stream.avail_in == before)) return output.finish(false);
  }
}

}  // namespace evbench
