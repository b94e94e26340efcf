#include "core/events/aedat4/aedat4.hpp"

#include "core/events/testing/fuzz_reader.hpp"

using namespace evbench;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return fuzz_reader(data, size, [](std::unique_ptr<ByteSource> bytes, const ReadOptions& options) {
    return std::make_unique<Aedat4Reader>(std::move(bytes), options);
  });
}
