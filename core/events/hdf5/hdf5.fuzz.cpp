#include "core/events/hdf5/reader.hpp"
#include "core/events/testing/fuzz_file.hpp"

/// The library loses some memory when it refuses a file.
extern "C" const char* __lsan_default_suppressions() { return "leak:libhdf5"; }

/// It asks for what a broken file says, and copes with getting nothing.
extern "C" const char* __asan_default_options() { return "allocator_may_return_null=1"; }

/// What kills the process that tries a file first (trial.hpp) is no finding.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return evbench::fuzz_file(data, size, evbench::hdf5_format());
}
