#include "bench/render/event_window.hpp"

#include "bench/render/testing/recording.hpp"
#include "core/testing/catch2.hpp"

using namespace evbench;
using namespace evbench::testing;

namespace {

std::vector<std::int64_t> times(std::span<const Event> events) {
  std::vector<std::int64_t> all;
  for (const Event& event : events) all.push_back(event.t);
  return all;
}

using Times = std::vector<std::int64_t>;

/// At 0, 10, ..., 90 us.
std::vector<Event> ten_events() {
  std::vector<Event> events;
  for (int i = 0; i < 10; ++i) events.push_back({10 * i, 1, 1, true});
  return events;
}

}  // namespace

TEST_CASE("A window holds the events of a duration before a time, wherever the stream's chunks end") {
  const TemporaryFolder folder;
  EventStream stream(write_native(folder, "a.evb", ten_events()));
  EventWindow window(stream, {.duration = 30});
  CHECK(window.next() == 0);
  CHECK(times(window.before(20)) == Times{0, 10});
  CHECK(window.next() == 20);
  CHECK(times(window.before(50)) == Times{20, 30, 40});
  CHECK(times(window.before(55)) == Times{30, 40, 50});  // windows overlap
  CHECK(times(window.before(1000)).empty());
  CHECK_FALSE(window.next());
}

TEST_CASE("A window of a count holds the newest events, however old") {
  const TemporaryFolder folder;
  EventStream stream(write_native(folder, "a.evb", ten_events()));
  EventWindow window(stream, {.count = 3});
  CHECK(times(window.before(11)) == Times{0, 10});
  CHECK(times(window.before(51)) == Times{30, 40, 50});
  CHECK(times(window.before(1000)) == Times{70, 80, 90});
}
