#include "eval/wilson.hpp"

#include "core/testing/catch2.hpp"

using namespace evbench;

TEST_CASE("Wilson's bounds are the shares that are 1.96 standard deviations from the measured one") {
  constexpr double z = 1.959963984540054;
  for (const auto& [successes, n] :
       {std::pair<std::size_t, std::size_t>{12, 16}, {1, 3}, {0, 10}, {0, 27}, {10, 10}, {200, 999}}) {
    const Share share = wilson(successes, n);
    const double p = static_cast<double>(successes) / static_cast<double>(n);
    CHECK(share.value == p);
    for (const double bound : {share.low, share.high}) {
      CHECK((p - bound) * (p - bound) == Approx(z * z * bound * (1.0 - bound) / static_cast<double>(n)).margin(1e-12));
    }
    CHECK(share.low >= 0.0);
    CHECK(share.high <= 1.0);
    CHECK(share.low <= p);
    CHECK(p <= share.high);
    CHECK(share.high - share.low > 0.01);
  }
}
