#include "core/data/calib.hpp"

#include "core/support/error.hpp"
#include "core/testing/catch2.hpp"
#include "core/testing/data.hpp"

using namespace evbench;
using Catch::Matchers::ContainsSubstring;

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

TEST_CASE("A damaged calibration is refused with its fault") {
  CHECK_THROWS_AS(calib(""), InputError);
  CHECK_THROWS_WITH(calib(""), ContainsSubstring("is empty"));
  CHECK_THROWS_WITH(calib("<?xml version=\"1.0\"?>\n<opencv_storage>\n"),
                    ContainsSubstring(":1: is XML, as DV writes"));
  CHECK_THROWS_WITH(calib("199 198 132\n"), ContainsSubstring("has 3 columns; expected 9"));
  CHECK_THROWS_WITH(calib("199 198 132 110 0.1\n"), ContainsSubstring("has 1 lens coefficients; expected k1 k2 p1 p2"));
  CHECK_THROWS_WITH(calib("199 198 132 110 1 2 3 4 5 6\n"),
                    ContainsSubstring("number 6 is 6: a lens model that evbench does not"));
  CHECK_THROWS_WITH(calib("199 198 132 110 0 0 0 0 0\n", DistortionModel::none),
                    ContainsSubstring("has 9 columns; expected 4"));
  CHECK_THROWS_WITH(calib("0 198 132 110 0 0 0 0 0\n"), ContainsSubstring("the first two > 0 px"));
  CHECK_THROWS_WITH(calib("199 198 132 nan 0 0 0 0 0\n"), ContainsSubstring("nan"));
  CHECK_THROWS_WITH(calib("1 1 1 1 0 0 0 0 0\n1 1 1 1 0 0 0 0 0\n"), ContainsSubstring("calib.txt:2: a second record"));
}

TEST_CASE("A calibration has as many lens coefficients as its tool writes") {
  CHECK(calib("199 198 132 110").distortion == DistortionModel::none);
  CHECK(calib("199,198,132,110,-0.37,0.15,-0.0003,-0.0008").coefficients[3] == -0.0008);
  CHECK(calib("199 198 132 110 1 2 3 4").coefficients[4] == 0.0);
  CHECK(calib("199 198 132 110 1 2 3 4 5 0 0 0").coefficients[4] == 5.0);
}

TEST_CASE("A principal point outside the image is refused with the image's size") {
  CHECK_THROWS_WITH(
      calib("500 500 320 240 0 0 0 0 0\n"),
      ContainsSubstring("calib.txt:1: has the principal point (320, 240), outside the image of 240x180 pixels"));
}

TEST_CASE("Kalibr's calibration is read with its own size and lens, and one of several cameras is selected by name") {
  const std::string cam0 = R"(cam0:
  camera_model: pinhole
  distortion_coeffs: [-0.37, 0.15, -0.0003, -0.0008]
  distortion_model: radtan
  intrinsics: [499.0, 498.0, 332.0, 210.0]
  resolution: [640, 480]
  rostopic: /dvs/image_raw
)";
  const Camera camera = calib(cam0);
  CHECK(camera.pinhole.fx == 499.0);
  CHECK(camera.distortion == DistortionModel::radial_tangential);
  CHECK(camera.coefficients[1] == 0.15);
  CHECK(camera.width == 640);
  const std::string both = cam0 + R"(cam1:
  camera_model: pinhole
  distortion_coeffs: [0.1, 0.2, 0.3, 0.4]
  distortion_model: equidistant
  intrinsics: [700, 701, 332.0, 210.0]
  resolution: [640, 480]
)";
  const testing::TemporaryFolder folder;
  const std::string path = folder.write("camchain.yaml", both);
  CHECK(read_calib(path, 240, 180, DistortionModel::none, "cam1").distortion == DistortionModel::equidistant);
  CHECK_THROWS_WITH(read_calib(path, 240, 180),
                    ContainsSubstring("camchain.yaml: holds cam0, cam1; expected the name"));
  CHECK_THROWS_WITH(read_calib(path, 240, 180, DistortionModel::none, "cam2"),
                    ContainsSubstring("has no camera \"cam2\"; did you mean"));
  CHECK_THROWS_WITH(calib("cam0:\n  camera_model: omni\n  distortion_model: none\n"),
                    ContainsSubstring("\"omni\"; expected pinhole"));
}

TEST_CASE("ROS's camera_info is read, with rational_polynomial if it is radial and tangential only") {
  const std::string info = R"(image_width: 346
image_height: 260
camera_name: davis
camera_matrix:
  rows: 3
  cols: 3
  data: [250.5, 0, 170.25, 0, 251.5, 130.75, 0, 0, 1]
distortion_model: rational_polynomial
distortion_coefficients:
  rows: 1
  cols: 8
  data: [-0.3, 0.1, 0.001, 0.002, -0.01, 0, 0, K6]
)";
  const auto with = [&](const std::string& from, const std::string& to) {
    return std::string(info).replace(info.find(from), from.size(), to);
  };
  const Camera camera = calib(with("K6", "0"));
  CHECK(camera.pinhole.fy == 251.5);
  CHECK(camera.pinhole.cx == 170.25);
  CHECK(camera.coefficients[4] == -0.01);
  CHECK(camera.height == 260);
  CHECK_THROWS_WITH(calib(with("K6", "0.2")), ContainsSubstring("8 lens coefficients, of which number 8 is 0.2"));
  CHECK_THROWS_WITH(calib("camera_matrix: {data: [1, 0, 2]}\n"),
                    ContainsSubstring("camera_matrix: is no camera matrix"));
  CHECK_THROWS_WITH(calib("name: x\n"), ContainsSubstring("is no camera; expected camera_model and intrinsics"));
  // The message as rostopic prints it.
  CHECK(calib("height: 260\nwidth: 346\ndistortion_model: plumb_bob\nD: [-0.3, 0.1, 0.0, 0.0, 0.0]\n"
              "K: [250.5, 0.0, 170.25, 0.0, 251.5, 130.75, 0.0, 0.0, 1.0]\n")
            .coefficients[0] == -0.3);
  const std::string four = "\nD: [-0.3, 0.1, 0.0, 0.0]\nK: [250.5, 0.0, 170.25, 0.0, 251.5, 130.75, 0.0, 0.0, 1.0]\n";
  CHECK(calib("distortion_model: kannala_brandt" + four).distortion == DistortionModel::equidistant);
  CHECK_THROWS_WITH(calib("distortion_model: fov" + four), ContainsSubstring("is \"fov\""));
}

TEST_CASE("OpenCV's calibration is read") {
  const Camera camera = calib(R"(%YAML:1.0
---
calibration_time: "Mon 02 Jan 2023"
image_width: 640
image_height: 480
camera_matrix: !!opencv-matrix
   rows: 3
   cols: 3
   dt: d
   data: [ 5.0e+02, 0., 3.2e+02, 0., 5.01e+02, 2.4e+02, 0., 0., 1. ]
distortion_coefficients: !!opencv-matrix
   rows: 5
   cols: 1
   dt: d
   data: [ -0.25, 0.01, 0., 0., 0.5 ]
)");
  CHECK(camera.pinhole.fy == 501.0);
  CHECK(camera.coefficients[0] == -0.25);
  CHECK(camera.coefficients[4] == 0.5);
  CHECK(camera.width == 640);
}
