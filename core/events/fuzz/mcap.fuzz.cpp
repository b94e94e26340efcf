#include "core/events/formats/all.hpp"
#include "core/events/fuzz/fuzz_file.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return evbench::fuzz_file(data, size, evbench::mcap_format());
}
