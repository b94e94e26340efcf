#include "core/events/native/native.hpp"

#include <algorithm>
#include <cstring>

#include "core/events/testing/fuzz_reader.hpp"

using namespace evbench;

namespace {

/// Corrects the checksums, as no mutation would, so that the code behind them is reached. Every other chunk keeps its
/// own checksum, which most likely is wrong.
void repair(std::vector<std::byte>& bytes) {
  native::Header header;
  if (bytes.size() < sizeof header) return;
  std::memcpy(&header, bytes.data(), sizeof header);
  const std::size_t size = bytes.size(), index = static_cast<std::size_t>(header.index_offset);
  if (header.index_offset <= size) {
    for (std::size_t i = 0; i < header.chunks && index + (i + 1) * sizeof(native::Chunk) <= size; i += 2) {
      native::Chunk chunk;
      std::byte* const place = bytes.data() + index + i * sizeof chunk;
      std::memcpy(&chunk, place, sizeof chunk);
      const std::size_t packed = native::packed_size(chunk.layout, chunk.events);
      if (chunk.offset > size || packed > size - chunk.offset) continue;
      chunk.hash = native::hash(std::span(bytes).subspan(static_cast<std::size_t>(chunk.offset), packed));
      std::memcpy(place, &chunk, sizeof chunk);
    }
    header.tail_hash = native::hash(std::span(bytes).subspan(index));
  }
  header.hash = native::hash(std::as_bytes(std::span(&header, 1)).first(offsetof(native::Header, hash)));
  std::memcpy(bytes.data(), &header, sizeof header);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto given = std::as_bytes(std::span(data, size));
  std::vector<std::byte> bytes(given.begin(), given.end());
  repair(bytes);
  return fuzz_reader(data, size, [&](std::unique_ptr<ByteSource>, const ReadOptions& options) {
    return std::make_unique<NativeReader>(std::span<const std::byte>(bytes), "fuzz", options);
  });
}
