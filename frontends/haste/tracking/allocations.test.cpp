#include <atomic>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <new>
#include <span>
#include <vector>

#include "core/testing/catch2.hpp"
#include "frontends/haste/tracking/testing/event_patterns.hpp"
#include "frontends/haste/tracking/tracker_set.hpp"

// Counts all allocations of this program, except where a sanitizer replaces them.
#if !defined(EVBENCH_SANITIZED)

namespace {

std::atomic<std::size_t> allocations{0};

void* allocate(std::size_t size, std::size_t alignment) {
  ++allocations;
  const std::size_t whole = (size + alignment - 1) / alignment * alignment;  // as aligned_alloc wants it
  if (void* memory = std::aligned_alloc(alignment, whole > 0 ? whole : alignment)) return memory;
  throw std::bad_alloc();
}

}  // namespace

// What is new[] comes here, too, by default.
void* operator new(std::size_t size) { return allocate(size, alignof(std::max_align_t)); }
void* operator new(std::size_t size, std::align_val_t alignment) {
  return allocate(size, static_cast<std::size_t>(alignment));
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::align_val_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept { std::free(memory); }

using namespace evbench;
using namespace evbench::haste;
using evbench::haste::testing::corner_lines;
using evbench::haste::testing::EventPattern;
using evbench::haste::testing::PatternPose;

TEST_CASE("Tracking allocates nothing for an event, nor for a change of state, by any of the variants", "[slow]") {
  EventPattern pattern;
  pattern.lines = corner_lines();
  pattern.pose = [](double t) { return PatternPose{{120.0 + 30.0 * std::sin(20.0 * t), 90.0}, 2.0 * t}; };
  pattern.rate = 200e3;
  const std::vector<Event> events = pattern.events(0.2, 1);
  for (const Variant variant : {Variant::correlation, Variant::haste_correlation, Variant::haste_correlation_star,
                                Variant::haste_difference, Variant::haste_difference_star}) {
    CAPTURE(static_cast<int>(variant));
    const bool slow = variant == Variant::correlation || variant == Variant::haste_difference;
    TrackerSet set(240, 180);
    for (int i = 0; i < (slow ? 2 : 20); ++i) {
      set.add(Tracker({.variant = variant}, {0, {116.0 + i % 5, 88.0 + i / 5}, 0.0}));
    }
    std::vector<Change> changes;
    changes.reserve(100'000);
    const auto half = static_cast<std::size_t>(std::ssize(events) / 2);
    set.push(std::span(events).first(half), changes);
    const std::size_t changes_before = changes.size();

    const std::size_t before = allocations;
    for (std::size_t i = half; i < events.size(); i += 1000) {  // in pieces, as they come
      set.push(std::span(events).subspan(i, std::min<std::size_t>(1000, events.size() - i)), changes);
    }
    const std::size_t after = allocations;
    CHECK(after - before == 0);
    CHECK(changes.size() > changes_before + 20);
    CHECK(changes.size() < changes.capacity());
  }
  CHECK(allocations > 0);  // they are counted
}

#endif
