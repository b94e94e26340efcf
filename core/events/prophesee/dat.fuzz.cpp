#include "core/events/prophesee/dat.hpp"

#include "core/events/testing/fuzz_reader.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return evbench::fuzz_reader(data, size, evbench::open_dat);
}
