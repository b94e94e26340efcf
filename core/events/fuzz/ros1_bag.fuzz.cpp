#include "core/events/formats/ros1_bag.hpp"

#include "core/events/fuzz/fuzz_reader.hpp"

using namespace evbench;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return fuzz_reader(data, size, [&](std::unique_ptr<ByteSource>, const ReadOptions& options) {
    return ros::read_bag("fuzz", "ROS 1 bag", options, [&](Faults& faults) {
      return std::make_unique<RosBag>(std::make_unique<MemoryBytes>(std::as_bytes(std::span(data, size)), "fuzz"),
                                      faults);
    });
  });
}
