#pragma once

#include <fmt/format.h>

#include "core/events/faults.hpp"

namespace evbench {

/// Counts one kind of fault while a part of a stream is decoded: cheaper than a Faults::add for each.
class FaultCount {
 public:
  void add(std::uint64_t offset) {
    if (count_++ == 0) first_ = offset;
  }
  /// `unit`: what the offsets count, e.g. "byte".
  void report(Faults& faults, const char* kind, const char* unit = "byte") const {
    if (count_ > 0) faults.add(kind, fmt::format("{} {}", unit, first_), count_);
  }

 private:
  std::int64_t count_ = 0;
  std::uint64_t first_ = 0;
};

}  // namespace evbench
