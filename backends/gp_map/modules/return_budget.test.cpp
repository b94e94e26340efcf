#include "backends/gp_map/modules/return_budget.hpp"

#include "core/testing/catch2.hpp"

namespace evbench::gp_map {

TEST_CASE("No more landmarks span any state than the budget allows") {
  ReturnBudget budget(2);
  CHECK(budget.spend(0, 10));
  CHECK(budget.spend(5, 8));         // two span states 5 to 7
  CHECK_FALSE(budget.spend(7, 20));  // and one that may not continue does not count
  CHECK(budget.spend(8, 12));
  CHECK_FALSE(budget.spend(3, 9));
  CHECK(budget.spend(10, 11));
  CHECK(budget.spend(12, 13));
}

TEST_CASE("Without a budget every re-acquired landmark becomes another one") {
  CHECK_FALSE(ReturnBudget(0).spend(3, 4));
}

}  // namespace evbench::gp_map
