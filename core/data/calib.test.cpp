#include "core/data/calib.hpp"

#include <catch2/catch.hpp>

#include "core/support/error.hpp"
#include "core/testing/data.hpp"

using namespace evbench;
using Catch::Matchers::Contains;

namespace {

Camera calib(const std::string& content, DistortionModel model = DistortionModel::radial_tangential) {
  const testing::TemporaryFolder folder;
  return read_calib(folder.write("calib.txt", content), 240, 180, model);
}

}  // namespace

TEST_CASE("A calibration gives pinhole, lens and the sensor's size") {
  const Camera camera = calib("199 198 132 110 -0.37 0.15 -0.0003 -0.0008 0.01\n");
  CHECK(camera.pinhole.fy == 198.0);
  CHECK(camera.pinhole.cx == 132.0);
  CHECK(camera.coefficients[2] == -0.0003);
  CHECK(camera.coefficients[4] == 0.01);
  CHECK(camera.width == 240);
  CHECK(camera.height == 180);
  CHECK(calib("199 198 132 110 1 2 3 4", DistortionModel::equidistant).coefficients[3] == 4.0);
  CHECK(calib("199 198 132 110", DistortionModel::none).distortion == DistortionModel::none);
}

TEST_CASE("A calibration that is written reads back as the same camera") {
  const std::string radial = "199.125 198 132 110 -0.37 0.15 -0.0003 -0.0008 0.01\n";
  CHECK(format_calib(calib(radial)) == radial);
  CHECK(format_calib(calib("199 198 132 110 1 2 3 4", DistortionModel::equidistant)) == "199 198 132 110 1 2 3 4\n");
  CHECK(format_calib(calib("199 198 132 110", DistortionModel::none)) == "199 198 132 110 0 0 0 0 0\n");
}

TEST_CASE("A damaged calibration is refused with what is wrong") {
  CHECK_THROWS_AS(calib(""), InputError);
  CHECK_THROWS_WITH(calib(""), Contains("is empty"));
  CHECK_THROWS_WITH(calib("199 198 132 110\n"), Contains("has 4 columns; expected 9"));
  CHECK_THROWS_WITH(calib("0 198 132 110 0 0 0 0 0\n"), Contains("focal lengths"));
  CHECK_THROWS_WITH(calib("199 198 132 nan 0 0 0 0 0\n"), Contains("nan"));
  CHECK_THROWS_WITH(calib("1 1 1 1 0 0 0 0 0\n1 1 1 1 0 0 0 0 0\n"), Contains("calib.txt:2: a second record"));
}
