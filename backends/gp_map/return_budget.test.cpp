#include "backends/gp_map/return_budget.hpp"

#include "core/testing/catch2.hpp"

namespace evbench::gp_map {

TEST_CASE("No more landmarks go on over any state than the budget has") {
  ReturnBudget budget(2);
  CHECK(budget.spend(0, 10));
  CHECK(budget.spend(5, 8));         // over states 5 to 7 there are two
  CHECK_FALSE(budget.spend(7, 20));  // and one that may not go on does not count
  CHECK(budget.spend(8, 12));
  CHECK_FALSE(budget.spend(3, 9));
  CHECK(budget.spend(10, 11));
  CHECK(budget.spend(12, 13));
}

TEST_CASE("Without a budget every landmark that comes back is another one") {
  CHECK_FALSE(ReturnBudget(0).spend(3, 4));
}

}  // namespace evbench::gp_map
