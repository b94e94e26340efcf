#include "core/events/longest_in_order.hpp"

#include <algorithm>

#include "core/simulation/random.hpp"
#include "core/testing/catch2.hpp"

using namespace evbench;

namespace {

std::vector<Event> at(const std::vector<std::int64_t>& times) {
  std::vector<Event> events;
  for (const std::int64_t t : times) events.push_back({t, 0, 0, true});
  return events;
}

/// By trying all predecessors, in O(n²).
std::size_t longest(const std::vector<Event>& events) {
  std::vector<std::size_t> length(events.size(), 1);
  std::size_t most = 0;
  for (std::size_t i = 0; i < events.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      if (events[j].t <= events[i].t) length[i] = std::max(length[i], length[j] + 1);
    }
    most = std::max(most, length[i]);
  }
  return most;
}

using Indices = std::vector<std::uint32_t>;

}  // namespace

TEST_CASE("As few events as possible are taken out so that the others are in order") {
  CHECK(longest_in_order({}).empty());
  CHECK(longest_in_order(at({1, 1, 2, 3})) == Indices{0, 1, 2, 3});
  CHECK(longest_in_order(at({1, 2, 100, 3, 4})) == Indices{0, 1, 3, 4});
  CHECK(longest_in_order(at({5, 6, 7, 1, 8})) == Indices{0, 1, 2, 4});
}

TEST_CASE("The longest order of random times is in order and as long as a search through all finds it") {
  Random random(7);
  for (int round = 0; round < 50; ++round) {
    std::vector<std::int64_t> times;
    for (int i = 0; i < 60; ++i)
      times.push_back(static_cast<std::int64_t>(random.uniform(0.0, 30.0)) + i / (1 + round % 7));
    const std::vector<Event> events = at(times);
    const Indices indices = longest_in_order(events);
    CHECK(indices.size() == longest(events));
    CHECK(std::is_sorted(indices.begin(), indices.end()));
    CHECK(std::is_sorted(indices.begin(), indices.end(),
                         [&](std::uint32_t a, std::uint32_t b) { return events[a].t < events[b].t; }));
  }
}
