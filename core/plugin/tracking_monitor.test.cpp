#include "core/plugin/tracking_monitor.hpp"

#include "core/testing/catch2.hpp"

using namespace evbench;
using Support = TrackingMonitor::Support;

TEST_CASE("Without a map tracking is not lost, and with a map and enough data it is ok") {
  TrackingMonitor monitor(1.0);
  CHECK(monitor.state() == TrackingState::no_map);
  monitor.observe(0.0, 0.1, Support::full);
  CHECK(monitor.state() == TrackingState::tracking);
  CHECK(monitor.status().state == RunState::ok);
}

TEST_CASE("Too little data is degraded while it lasts, and a motion model alone for longer than the patience is lost") {
  TrackingMonitor monitor(1.0);
  monitor.observe(0.0, 0.1, Support::full);
  for (int i = 1; i < 30; ++i) monitor.observe(0.1 * i, 0.1 * (i + 1), Support::weak, "few");
  CHECK(monitor.state() == TrackingState::degraded);
  monitor.observe(3.0, 3.1, Support::full);
  CHECK(monitor.state() == TrackingState::tracking);
  REQUIRE(monitor.status().degraded.size() == 1);
  CHECK(monitor.status().degraded[0].from == Approx(0.1));
  CHECK(monitor.status().degraded[0].to == Approx(3.0));
  CHECK(monitor.status().reason == "few");
  monitor.observe(3.1, 4.1, Support::none, "nothing");
  CHECK(monitor.state() == TrackingState::degraded);
  monitor.observe(4.1, 4.2, Support::none, "nothing");
  CHECK(monitor.state() == TrackingState::lost);
  CHECK(monitor.status().state == RunState::lost);
  CHECK(monitor.status().time == Approx(3.1));
  CHECK_THAT(monitor.status().reason, Catch::Matchers::ContainsSubstring("nothing for more than 1 s"));
  monitor.observe(4.2, 4.3, Support::full);
  CHECK(monitor.lost());  // for good
}

TEST_CASE("A new map ends the degraded span at its beginning and restarts the patience") {
  TrackingMonitor monitor(1.0);
  monitor.observe(0.0, 1.0, Support::full);
  monitor.observe(1.0, 1.9, Support::none, "nothing");
  monitor.recovered(1.4);
  CHECK(monitor.state() == TrackingState::tracking);
  CHECK(monitor.status().degraded.at(0).to == 1.4);
  monitor.observe(1.9, 2.8, Support::none, "nothing");
  CHECK_FALSE(monitor.lost());
  CHECK(monitor.status().degraded.size() == 2);
}

TEST_CASE("A doubtful estimate is degraded with the reason, and a lost one stays lost") {
  TrackingMonitor monitor(1.0);
  monitor.observe(0.0, 0.1, Support::weak, "few");
  monitor.doubt(0.0, 3.0, "halves differ");
  CHECK(monitor.status().state == RunState::degraded);
  CHECK(monitor.status().reason == "few");  // what came first
  REQUIRE(monitor.status().degraded.size() == 2);
  CHECK(monitor.status().degraded[1].reason == "halves differ");
  CHECK(monitor.status().degraded[1].to == 3.0);
  monitor.lose(2.0, "nothing is seen");
  monitor.doubt(0.0, 3.0, "halves differ");
  CHECK(monitor.status().state == RunState::lost);
  CHECK(monitor.status().reason == "nothing is seen");
}
