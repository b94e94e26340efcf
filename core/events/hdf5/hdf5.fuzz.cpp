#include "core/events/hdf5/reader.hpp"
#include "core/events/testing/fuzz_file.hpp"

/// The library loses some memory when it refuses a file.
extern "C" const char* __lsan_default_suppressions() { return "leak:libhdf5"; }

/// The library allocates what a broken file states, and copes if it gets nothing.
extern "C" const char* __asan_default_options() { return "allocator_may_return_null=1"; }

/// Crashes of the process that tries a file first (trial.hpp) are no finding.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return evbench::fuzz_file(data, size, evbench::hdf5_format());
}
