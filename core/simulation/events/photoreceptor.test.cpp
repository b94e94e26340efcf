#include "core/simulation/events/photoreceptor.hpp"

#include <cmath>
#include <functional>

#include "core/testing/catch2.hpp"

using namespace evbench;

namespace {

/// One pixel; intervals of 0.25 ms.
class OnePixel : public Brightness {
 public:
  explicit OnePixel(std::function<double(double)> light) : light_(std::move(light)) {}
  int width() const override { return 1; }
  int height() const override { return 1; }
  void start(double t) override { set(t); }
  double advance(double limit) override {
    from_ = t_;
    set(std::min(t_ + 0.25e-3, limit));
    return t_;
  }
  std::span<const float> image() const override { return {&now_, 1}; }
  float within(int, int, int part) const override {
    return static_cast<float>(light_(from_ + (t_ - from_) * part / kParts));
  }

 private:
  void set(double t) {
    t_ = t;
    now_ = static_cast<float>(light_(t));
  }
  std::function<double(double)> light_;
  double from_ = 0.0, t_ = 0.0;
  float now_ = 0.0F;
};

}  // namespace

TEST_CASE("A photoreceptor's response to a step is exponential, ten times slower in the dark") {
  for (const auto& [light, bandwidth] : {std::pair(0.0, 50.0), {-9.0, 5.0}}) {  // log intensity; [Hz]
    Photoreceptor receptor(
        std::make_unique<OnePixel>([light = light](double t) { return t < 0.0105 ? light : light + 0.01; }), 50.0);
    receptor.start(0.0);
    for (double t = 0.0; t < 0.05; t = receptor.advance(0.05)) {
      if (t < 0.012) continue;
      const double expected = light + 0.01 * (1.0 - std::exp(-2.0 * M_PI * bandwidth * (t - 0.0105)));
      CHECK(receptor.image()[0] == Approx(expected).margin(4e-4));
    }
  }
}

TEST_CASE("A photoreceptor lets slow light pass and damps fast light by its amplitude response") {
  for (const double frequency : {5.0, 50.0, 200.0}) {
    const double amplitude = 0.02;  // little, so that the bandwidth stays the same
    Photoreceptor receptor(std::make_unique<OnePixel>(
                               [&](double t) { return -amplitude + amplitude * std::sin(2.0 * M_PI * frequency * t); }),
                           100.0);
    receptor.start(0.0);
    double largest = -1.0;
    for (double t = 0.0; t < 1.0; t = receptor.advance(1.0)) {
      if (t < 0.5) continue;
      for (int part = 1; part < Brightness::kParts; ++part) {
        largest = std::max(largest, static_cast<double>(receptor.within(0, 0, part)) + amplitude);
      }
    }
    CHECK(largest == Approx(amplitude / std::hypot(1.0, frequency / 100.0)).epsilon(0.03));
  }
}
