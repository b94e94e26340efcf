#include "backends/gp_map/modules/state_placement.hpp"

#include <algorithm>
#include <optional>

#include "core/testing/catch2.hpp"

namespace evbench::gp_map {
namespace {

using Rule = PlacementOptions::Rule;

/// One observation a millisecond; ten tracks that all move at `speed` [px/s], except for an outlier.
std::vector<UndistortedObservation> moving(double speed, double until) {
  std::vector<UndistortedObservation> result;
  for (int i = 0; 1e-3 * i <= until; ++i) {
    const double t = 1e-3 * i;
    result.push_back({i % 10, t, {(i % 10 == 0 ? 1000.0 : speed) * t, 5.0}, 1.0});
  }
  return result;
}

std::vector<double> placed(const PlacementOptions& options, const std::vector<UndistortedObservation>& observations,
                           double batch) {
  StatePlacement placement(options);
  std::vector<double> times;
  std::size_t next = 0;
  for (double now = batch; next < observations.size(); now += batch) {
    for (; next < observations.size() && observations[next].t <= now; ++next) placement.observe(observations[next]);
    while (const auto t = placement.next(std::min(now, observations.back().t))) {
      CHECK(*t <= now);
      times.push_back(*t);
    }
  }
  if (const auto t = placement.last()) times.push_back(*t);
  return times;
}

}  // namespace

TEST_CASE(
    "By prediction, a state is placed when most tracks are off their prediction, otherwise at the greatest spacing") {
  PlacementOptions options;
  options.min_spacing = 0.01;
  options.max_spacing = 0.1;
  StatePlacement placement(options);
  for (const UndistortedObservation& z : moving(100.0, 0.5)) placement.observe(z);
  std::vector<double> times;
  const auto next = [&] {
    const auto t = placement.next(0.5);
    if (t) times.push_back(*t);
    return t.has_value();
  };
  REQUIRE(next());
  REQUIRE(next());  // without a prediction
  CHECK(times == std::vector{0.0, 0.1});
  // One track of ten always deviates, all do from 0.25 s on.
  placement.predict([&](const UndistortedObservation& z) {
    return std::optional<double>(z.track == 0 || z.t > 0.25 ? 2.0 * options.deviation : 0.5 * options.deviation);
  });
  while (next()) {
  }
  REQUIRE(times.size() > 5);
  CHECK(times[2] == Approx(0.2));
  CHECK(times[3] > 0.25);
  CHECK(times[3] < 0.26);
  for (std::size_t i = 4; i < times.size(); ++i) CHECK(times[i] - times[i - 1] == Approx(0.01).margin(0.002));
}

TEST_CASE("By rate, control states are evenly spaced from the first observation past the last one") {
  PlacementOptions options;
  options.rule = Rule::rate;
  options.rate = 8.0;
  const auto times = placed(options, moving(0.0, 1.05), 0.01);
  REQUIRE(times.size() == 10);
  for (std::size_t k = 0; k < times.size(); ++k) CHECK(times[k] == Approx(0.125 * static_cast<double>(k)));
}

TEST_CASE("By observations, a control state is placed when their number is reached, within the spacings") {
  PlacementOptions options;
  options.rule = Rule::observations;
  options.min_spacing = 0.01;
  options.max_spacing = 0.1;
  options.observations = 40;
  CHECK(placed(options, moving(0.0, 0.25), 0.01)[1] == Approx(0.04));
  options.observations = 4;
  CHECK(placed(options, moving(0.0, 0.25), 0.01)[1] == Approx(0.01));
  options.observations = 1000;
  CHECK(placed(options, moving(0.0, 0.25), 0.01)[1] == Approx(0.1));
}

TEST_CASE("By motion, the states' spacing follows the median speed in the image") {
  PlacementOptions options;
  options.rule = Rule::motion;
  options.min_spacing = 0.01;
  options.max_spacing = 0.1;
  options.motion = 2.0;
  const auto spacing = [&](double speed) {
    const auto times = placed(options, moving(speed, 0.5), 0.01);
    return times[3] - times[2];
  };
  CHECK(spacing(50.0) == Approx(0.04).margin(0.012));  // a track is seen every 10 ms
  CHECK(spacing(100.0) == Approx(0.02).margin(0.006));
  CHECK(spacing(0.0) == Approx(0.1));
  CHECK(spacing(10000.0) == Approx(0.01).margin(1e-9));
}

TEST_CASE("Placement does not depend on how observations are split into batches") {
  PlacementOptions options;
  for (const auto rule : {Rule::rate, Rule::observations, Rule::motion}) {
    options.rule = rule;
    const auto observations = moving(70.0, 0.6);
    CHECK(placed(options, observations, 0.003) == placed(options, observations, 0.25));
  }
}

TEST_CASE("The next state is not later than announced") {
  for (const auto rule : {Rule::rate, Rule::observations, Rule::motion}) {
    PlacementOptions options;
    options.rule = rule;
    StatePlacement placement(options);
    for (const auto& observation : moving(30.0, 0.5)) {
      const double announced = (placement.observe(observation), placement.upcoming());
      if (const auto t = placement.next(observation.t)) CHECK(*t <= announced);
    }
  }
}

}  // namespace evbench::gp_map
