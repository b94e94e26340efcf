#include "core/events/ros/ros1_bag.hpp"

#include "core/events/testing/fuzz_file.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return evbench::fuzz_file(data, size, evbench::ros1_bag_format());
}
