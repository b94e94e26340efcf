#include "core/simulation/events/event_simulator.hpp"

#include <tbb/global_control.h>

#include <cmath>
#include <functional>
#include <map>

#include "core/events/event_stream.hpp"
#include "core/testing/catch2.hpp"

using namespace evbench;

namespace {

/// Log intensity by a formula; intervals of equal length.
class Formula : public Brightness {
 public:
  using Function = std::function<double(double x, double y, double t)>;
  Formula(int width, int height, double interval, Function function)
      : width_(width), height_(height), interval_(interval), function_(std::move(function)) {}

  int width() const override { return width_; }
  int height() const override { return height_; }
  void start(double t) override {
    to_ = t;
    fill();
  }
  double advance(double limit) override {
    from_ = to_;
    to_ = std::min(from_ + interval_, limit);
    fill();
    return to_;
  }
  std::span<const float> image() const override { return image_; }
  float within(int x, int y, int part) const override {
    return static_cast<float>(function_(x, y, from_ + (to_ - from_) * part / kParts));
  }

 private:
  void fill() {
    image_.clear();
    for (int y = 0; y < height_; ++y) {
      for (int x = 0; x < width_; ++x) image_.push_back(static_cast<float>(function_(x, y, to_)));
    }
  }

  int width_, height_;
  double interval_;
  Function function_;
  double from_ = 0.0, to_ = 0.0;
  std::vector<float> image_;
};

/// Without anything that is not the same in every pixel.
SimulatorOptions ideal() {
  SimulatorOptions options;
  options.sensor = {.threshold_mismatch = 0.0, .refractory = 0.0, .noise_rate = 0.0, .leak_rate = 0.0};
  return options;
}

std::vector<Event> all_events(EventReader& reader) {
  std::vector<Event> all;
  for (std::vector<Event> chunk; reader.read(chunk);) all.insert(all.end(), chunk.begin(), chunk.end());
  return all;
}

std::vector<Event> simulate(int width, int height, double interval, double duration, const SimulatorOptions& options,
                            const Formula::Function& function, std::uint64_t seed = 1) {
  EventSimulator simulator(std::make_unique<Formula>(width, height, interval, function), options, duration, seed);
  return all_events(simulator);
}

/// Rises and falls at every pixel, differently.
double waves(double x, double y, double t) {
  return std::sin(20.0 * t + 0.3 * x + 0.7 * y) + 0.5 * std::sin(93.0 * t + x);
}

double mean(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double value : values) sum += value;
  return sum / static_cast<double>(values.size());
}

}  // namespace

TEST_CASE("The thresholds measured on a known ramp of brightness are the nominal ones, ON and OFF apart") {
  SimulatorOptions options = ideal();
  options.sensor.threshold_on = 0.17;
  options.sensor.threshold_off = 0.31;
  for (const double slope : {40.0, -40.0}) {
    const auto events = simulate(8, 8, 1e-3, 1.0, options, [slope](double, double, double t) { return slope * t; });
    const double measured = 64.0 * 40.0 / static_cast<double>(events.size());
    CHECK(measured == Approx(slope > 0.0 ? 0.17 : 0.31).epsilon(0.01));
    for (const Event& event : events) REQUIRE(event.on == (slope > 0.0));
  }
}

TEST_CASE("The mean threshold on a ramp is the nominal one, and its spread over the pixels the mismatch") {
  SimulatorOptions options = ideal();
  options.sensor.threshold_mismatch = 0.03;
  const auto events = simulate(64, 64, 1e-3, 1.0, options, [](double, double, double t) { return 100.0 * t; });
  std::map<std::pair<int, int>, int> counts;
  for (const Event& event : events) ++counts[{event.x, event.y}];
  std::vector<double> thresholds, squares;
  for (const auto& [pixel, count] : counts) thresholds.push_back(100.0 / count);
  for (const double threshold : thresholds) squares.push_back((threshold - 0.2) * (threshold - 0.2));
  CHECK(thresholds.size() == 64 * 64);
  CHECK(mean(thresholds) == Approx(0.2).epsilon(0.01));
  CHECK(std::sqrt(mean(squares)) == Approx(0.03).epsilon(0.05));
}

TEST_CASE("A step edge that moves at a known speed is seen when it passes each pixel, to 10 us") {
  const double speed = GENERATE(100.0, 1000.0);    // px/s
  constexpr double kBlur = 0.45, kContrast = 1.5;  // px, of the log intensity
  // Log intensity of an edge between I = 1 and I = exp(1.5), blurred by a Gaussian.
  const auto edge = [&](double x, double, double t) {
    const double bright = 0.5 * std::erfc(-(speed * t - x - 2.0) / (kBlur * M_SQRT2));
    return std::log(1.0 + (std::exp(kContrast) - 1.0) * bright);
  };
  SimulatorOptions options = ideal();
  const double duration = 44.0 / speed, interval = 0.5 / speed;  // half a pixel between renderings
  const auto events = simulate(40, 2, interval, duration, options, edge);
  REQUIRE(events.size() == 40 * 2 * 7);
  std::map<std::pair<int, int>, int> counts;
  double worst = 0.0;
  for (const Event& event : events) {
    const double level = 0.2 * ++counts[{event.x, event.y}];
    double low = 0.0, high = duration;  // when the edge's log intensity passes that level
    while (high - low > 1e-9) {
      const double middle = 0.5 * (low + high);
      (edge(event.x, event.y, middle) < level ? low : high) = middle;
    }
    worst = std::max(worst, std::abs(1e-6 * static_cast<double>(event.t) - low));
  }
  CHECK(worst < 10e-6);
}

TEST_CASE("Event times are off by the jitter that is configured, and still in order") {
  SimulatorOptions options = ideal();
  const auto ramp = [](double, double, double t) { return 2.0 * t; };
  const auto exact = simulate(32, 32, 1e-3, 1.0, options, ramp);
  options.sensor.jitter = 50e-6;
  const auto jittered = simulate(32, 32, 1e-3, 1.0, options, ramp);
  REQUIRE(exact.size() == jittered.size());
  CHECK(std::ranges::is_sorted(jittered, {}, &Event::t));
  std::map<std::pair<int, int>, std::vector<std::int64_t>> by_pixel;
  for (const Event& event : exact) by_pixel[{event.x, event.y}].push_back(event.t);
  std::map<std::pair<int, int>, std::size_t> next;
  std::vector<double> squares;
  for (const Event& event : jittered) {
    const std::pair pixel(event.x, event.y);
    const double error = static_cast<double>(event.t - by_pixel[pixel][next[pixel]++]);
    squares.push_back(error * error);
  }
  CHECK(std::sqrt(mean(squares)) == Approx(50.0).epsilon(0.03));
}

TEST_CASE("A pixel is blind for the refractory period and then goes on from the brightness that it finds") {
  SimulatorOptions options = ideal();
  options.sensor.refractory = 5e-3;
  const auto events = simulate(1, 1, 1e-3, 0.995, options, [](double, double, double t) { return 20.0 * t; });
  REQUIRE(events.size() == 66);  // every 0.2 / 20 + 0.005 s
  for (std::size_t i = 0; i < events.size(); ++i)
    REQUIRE(std::abs(events[i].t - 15000 * static_cast<int>(i) - 10000) <= 1);
}

TEST_CASE("Noise, leak and hot pixels make events at their rates where nothing changes") {
  const auto still = [](double, double, double) { return 0.0; };
  SimulatorOptions options = ideal();
  CHECK(simulate(64, 64, 0.01, 2.0, options, still).empty());
  const auto share_on = [](const std::vector<Event>& events) {
    return static_cast<double>(std::ranges::count(events, true, &Event::on)) / static_cast<double>(events.size());
  };
  options.sensor.noise_rate = 2.0;
  const auto noise = simulate(64, 64, 0.01, 2.0, options, still);
  CHECK(static_cast<double>(noise.size()) == Approx(64 * 64 * 4).epsilon(0.03));
  CHECK(share_on(noise) == Approx(0.5).margin(0.02));
  options = ideal();
  options.sensor.leak_rate = 2.0;
  options.sensor.threshold_mismatch = 0.02;
  const auto leak = simulate(64, 64, 0.01, 2.0, options, still);
  CHECK(static_cast<double>(leak.size()) == Approx(64 * 64 * 4).epsilon(0.03));
  CHECK(share_on(leak) == 1.0);
  CHECK(std::ranges::count_if(leak, [](const Event& e) { return e.t < 250000; }) == Approx(64 * 64 / 2).epsilon(0.1));
  options = ideal();
  options.sensor.hot_share = 0.05;
  const auto hot = simulate(64, 64, 0.01, 2.0, options, still);
  std::map<std::pair<int, int>, int> counts;
  for (const Event& event : hot) ++counts[{event.x, event.y}];
  CHECK(static_cast<double>(counts.size()) == Approx(0.05 * 64 * 64).epsilon(0.2));
  CHECK(static_cast<double>(hot.size()) == Approx(200.0 * static_cast<double>(counts.size())).epsilon(0.03));
}

TEST_CASE("The number of threads does not change the events, and another seed does") {
  const tbb::global_control four(tbb::global_control::max_allowed_parallelism, 4);
  SimulatorOptions options;
  options.sensor.jitter = 20e-6;
  options.sensor.hot_share = 0.01;
  options.threads = 1;
  const auto one = simulate(60, 45, 2e-3, 0.5, options, waves);
  CHECK(one.size() > 50000);
  for (const int threads : {2, 4}) {
    options.threads = threads;
    CHECK(simulate(60, 45, 2e-3, 0.5, options, waves) == one);
  }
  CHECK(simulate(60, 45, 2e-3, 0.5, options, waves, 2) != one);
}

TEST_CASE("Events come in the order of time, row and column, and those of a pixel in the order of time") {
  SimulatorOptions options;
  options.sensor.jitter = 100e-6;
  const auto events = simulate(60, 45, 2e-3, 0.3, options, waves);
  const auto key = [](const Event& event) { return std::tuple(event.t, event.y, event.x); };
  CHECK(std::ranges::is_sorted(events, {}, key));
  CHECK(events.front().t >= 0);
}

TEST_CASE("A simulation can be used as a recording: in a range of time, and again from any time") {
  const SimulatorOptions options;
  const auto make = [&] {
    return std::make_unique<EventSimulator>(std::make_unique<Formula>(30, 20, 2e-3, waves), options, 0.5, 1);
  };
  auto all = all_events(*make());
  EventStream stream(make(), "simulation", {.from = 200000, .to = 300000});
  std::vector<Event> part;
  for (std::vector<Event> chunk; stream.read(chunk);) part.insert(part.end(), chunk.begin(), chunk.end());
  std::erase_if(all, [](const Event& event) { return event.t < 200000 || event.t >= 300000; });
  REQUIRE_FALSE(all.empty());
  CHECK(part == all);
  CHECK(stream.faults().empty());
  stream.seek(250000);
  std::vector<Event> chunk;
  REQUIRE(stream.read(chunk));
  CHECK(chunk.front() == *std::ranges::find_if(all, [](const Event& event) { return event.t >= 250000; }));
}

TEST_CASE("An outage has no events, and everything else is as without it") {
  SimulatorOptions options;
  options.sensor.jitter = 100e-6;
  auto all = simulate(30, 20, 2e-3, 0.5, options, waves);
  options.outages = {0.1, 0.2, 0.25, 0.3};
  const auto with_outages = simulate(30, 20, 2e-3, 0.5, options, waves);
  const auto is_in_outage = [](const Event& event) {
    return (event.t >= 100'000 && event.t < 200'000) || (event.t >= 250'000 && event.t < 300'000);
  };
  CHECK(std::erase_if(all, is_in_outage) > 1000);
  CHECK(with_outages == all);
  options.outages = {0.1, 0.2, 0.15};
  CHECK_THROWS_WITH(simulate(30, 20, 2e-3, 0.5, options, waves),
                    Catch::Matchers::ContainsSubstring("simulator.outages"));
}
