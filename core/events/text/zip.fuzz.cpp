#include "core/events/testing/fuzz_file.hpp"
#include "core/events/text/ecd_text.hpp"

/// Only archives: ecd_text.fuzz.cpp covers the text.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0 || data[0] != 'P') return 0;
  return evbench::fuzz_file(data, size, evbench::ecd_text_format());
}
