#include "eval/holm.hpp"

#include "core/testing/catch2.hpp"

namespace evbench {

TEST_CASE("Holm's correction of several comparisons, in their order") {
  // R: p.adjust(c(0.04, 0.01, 0.03, 0.005), "holm")
  const std::vector<double> corrected = holm(std::vector<double>{0.04, 0.01, 0.03, 0.005});
  REQUIRE(corrected.size() == 4);
  CHECK(corrected[0] == Approx(0.06));
  CHECK(corrected[1] == Approx(0.03));
  CHECK(corrected[2] == Approx(0.06));
  CHECK(corrected[3] == Approx(0.02));
  CHECK(holm(std::vector<double>{0.9, 0.8})[0] == 1.0);
  CHECK(holm({}).empty());
}

}  // namespace evbench
