#include "eval/wilcoxon.hpp"

#include <limits>
#include <vector>

#include "core/testing/catch2.hpp"

namespace evbench {

// Expected values: scipy.stats.wilcoxon of scipy 1.10.1, unless another source is named.

TEST_CASE("Wilcoxon's test is exact for few pairs, as scipy's") {
  const SignedRanks plants =
      signed_rank_test(std::vector<double>{6, 8, 14, 16, 23, 24, 28, 29, 41, -48, 49, 56, 60, -67, 75});
  CHECK(plants.negative == 24.0);
  CHECK(plants.positive == 96.0);
  CHECK(plants.p == Approx(0.041259765625).epsilon(1e-12));
  CHECK(plants.rank_biserial == Approx(0.6));
  CHECK(plants.pairs == 15);
  const SignedRanks few = signed_rank_test(std::vector<double>{0.5, -0.2, 1.1, 0.9, -0.4, 1.6, 0.7});
  CHECK(few.negative == 3.0);
  CHECK(few.p == Approx(0.078125).epsilon(1e-12));
}

TEST_CASE("Wilcoxon's test is normal for many pairs, with zeros left out and shared ranks, as scipy's") {
  std::vector<double> spread, coarse;
  for (int i = 0; i < 60; ++i) spread.push_back((i * 37) % 101 - 38);
  CHECK(signed_rank_test(spread).p == Approx(0.007127646135735789).epsilon(1e-10));
  for (int i = 0; i < 66; ++i) coarse.push_back((i * 7) % 11 - 3);
  const SignedRanks result = signed_rank_test(coarse);
  CHECK(result.pairs == 60);
  CHECK(result.negative == 333.0);
  CHECK(result.p == Approx(1.7156309108560135e-05).epsilon(1e-10));
}

TEST_CASE("Shared ranks are part of the exact test") {
  // Counted over all 256 choices of signs: 34 have a sum as far out.
  const SignedRanks result = signed_rank_test(std::vector<double>{1, 1, 2, -2, 3, 4, -1, 5});
  CHECK(result.positive == 29.5);
  CHECK(result.negative == 6.5);
  CHECK(result.p == Approx(34.0 / 256.0).epsilon(1e-12));
}

TEST_CASE("A pair with one failure ranks above all others, and differences of zero are left out") {
  const double inf = std::numeric_limits<double>::infinity();
  const SignedRanks result = signed_rank_test(std::vector<double>{0.0, -1.0, inf, inf, -2.0});
  CHECK(result.pairs == 4);
  CHECK(result.positive == 7.0);
  CHECK(result.negative == 3.0);
  const SignedRanks equal = signed_rank_test(std::vector<double>{0.0, 0.0});
  CHECK(equal.pairs == 0);
  CHECK(equal.p == 1.0);
  CHECK(equal.rank_biserial == 0.0);
}

TEST_CASE("The smallest p depends on the number of pairs") {
  const std::vector<double> all_above = {1, 2, 3, 4, 5};
  CHECK(signed_rank_test(all_above).p == Approx(smallest_p(5)));
  CHECK(smallest_p(5) == 0.0625);
  CHECK(smallest_p(0) == 1.0);
}

}  // namespace evbench
