#include "bench/sweep/time_left.hpp"

#include "core/testing/catch2.hpp"

using namespace evbench;

TEST_CASE("A run is expected to take as long as those of its label, before those of its axes") {
  RunDurations durations;
  CHECK(durations.expected({"fast", {}}) == 0.0);
  durations.add({"fast", {"frames=0.1"}}, 1.0);
  CHECK(durations.expected({"slow", {"frames=0.1"}}) == 1.0);  // the only one that is known
  durations.add({"slow", {"frames=0.1"}}, 100.0);
  CHECK(durations.expected({"slow", {"frames=1"}}) == 100.0);
  CHECK(durations.expected({"fast", {"frames=1"}}) == 1.0);
  CHECK(durations.expected({"other", {"frames=0.1"}}) == Approx(50.5));
}

TEST_CASE("Among runs of a label those with most values in common count") {
  RunDurations durations;
  durations.add({"a", {"frames=0.01"}}, 80.0);
  durations.add({"a", {"frames=0.01"}}, 120.0);
  durations.add({"a", {"frames=1"}}, 1.0);
  CHECK(durations.expected({"a", {"frames=0.01"}}) == Approx(100.0));
  CHECK(durations.expected({"a", {"frames=1"}}) == 1.0);
  CHECK(durations.expected({"a", {"frames=0.1"}}) == Approx(67.0));
}

TEST_CASE("A run starts where another has ended, and the end of the last one counts") {
  CHECK(time_left({}, 2) == 0.0);
  CHECK(time_left(std::vector{10.0, 1.0, 1.0, 1.0}, 1) == 13.0);
  CHECK(time_left(std::vector{10.0, 1.0, 1.0, 1.0}, 2) == 10.0);
  CHECK(time_left(std::vector{1.0, 1.0, 10.0}, 2) == 11.0);
}
