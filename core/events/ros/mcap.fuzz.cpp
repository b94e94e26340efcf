#include "core/events/ros/mcap.hpp"

#include "core/events/testing/fuzz_file.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return evbench::fuzz_file(data, size, evbench::mcap_format());
}
