#include "core/smoother/engine/lane_math.hpp"

#include <random>
#include <vector>

#include "core/smoother/engine/lane_loss.hpp"
#include "core/support/index.hpp"
#include "core/testing/catch2.hpp"

namespace evbench::smoother {
namespace {

/// Values of all magnitudes; their number is a multiple of kLanes.
std::vector<double> all_magnitudes() {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> exponent(-1074.0, 1024.0), mantissa(1.0, 2.0), moderate(-60.0, 10.0);
  std::vector<double> values = {0.0, 5e-324, 1e-308, 0x1p-53, 0x1p-52, 0.41421356, 0.41421357, 0.5,
                                1.0, 2.0,    3.0,    0x1p53,  0x1p54,  1e300,      1.7e308,    1.4142135623730951};
  for (int i = 0; i < 50'000; ++i) {
    values.push_back(std::ldexp(mantissa(random), static_cast<int>(exponent(random))));
    values.push_back(std::exp2(moderate(random)));
  }
  for (double& value : values) value = std::min(value, std::numeric_limits<double>::max());
  values.resize(values.size() / kLanes * kLanes);
  return values;
}

double ulp(double x) { return std::nextafter(std::abs(x), std::numeric_limits<double>::infinity()) - std::abs(x); }

}  // namespace

TEST_CASE("log1p of lanes agrees with the library's within 2 ulp, for every magnitude") {
  const std::vector<double> values = all_magnitudes();
  double worst = 0.0;
  for (std::size_t i = 0; i < values.size(); i += kLanes) {
    const Lane result = log1p(load(values.data() + i));
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      const double expected = std::log1p(values[i + lane]);
      worst = std::max(worst, std::abs(result[lane] - expected) / ulp(expected));
    }
  }
  CHECK(worst <= 2.0);
  CHECK(std::isinf(log1p(broadcast(std::numeric_limits<double>::infinity()))[0]));
  CHECK(std::isnan(log1p(broadcast(std::numeric_limits<double>::quiet_NaN()))[0]));
}

TEST_CASE("A robust loss of lanes equals the loss of each lane") {
  const std::vector<double> values = all_magnitudes();
  for (const RobustLoss& loss :
       {RobustLoss(), RobustLoss(RobustLoss::Kind::huber, 1.5), RobustLoss(RobustLoss::Kind::cauchy, 2.0, 0.3)}) {
    double worst = 0.0;
    for (std::size_t i = 0; i < values.size(); i += kLanes) {
      const LaneLoss result = loss_of(loss, load(values.data() + i));
      for (std::size_t lane = 0; lane < kLanes; ++lane) {
        const double value = loss.value(values[i + lane]), weight = loss.weight(values[i + lane]);
        worst = std::max(worst, std::abs(result.value[lane] - value) / ulp(value));
        worst = std::max(worst, std::abs(result.weight[lane] - weight) / ulp(weight));
      }
    }
    CHECK(worst <= 3.0);
  }
}

}  // namespace evbench::smoother
