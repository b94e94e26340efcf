#include "core/events/formats/all.hpp"
#include "core/events/fuzz/fuzz_file.hpp"

// No test of CI: the HDF5 library (1.10.8, Debian 12) itself crashes on some broken files, by overflows in its old kind
// of groups (H5HL, H5G__stab) for instance, after some ten thousand inputs. To go on behind that: -fork=1
// -ignore_crashes=1 -malloc_limit_mb=100000, with ASAN_OPTIONS=allocator_may_return_null=1.

/// The library loses some memory when it refuses a file.
extern "C" const char* __lsan_default_suppressions() { return "leak:libhdf5"; }

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return evbench::fuzz_file(data, size, evbench::hdf5_format());
}
