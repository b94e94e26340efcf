#include "core/data/calib.hpp"

#include <fmt/format.h>

#include "core/io/text_reader.hpp"
#include "core/support/error.hpp"

namespace evbench {
namespace {

struct Layout {
  std::size_t coefficients;
  const char* columns;
};

Layout layout(DistortionModel model) {
  switch (model) {
    case DistortionModel::radial_tangential: return {5, "fx fy cx cy k1 k2 p1 p2 k3"};
    case DistortionModel::equidistant: return {4, "fx fy cx cy k1 k2 k3 k4"};
    case DistortionModel::none: break;
  }
  return {0, "fx fy cx cy"};
}

}  // namespace

Camera read_calib(const std::string& path, int width, int height, DistortionModel model) {
  TextReader reader(path);
  const Layout expected = layout(model);
  if (!reader.next()) throw InputError(fmt::format("{}: is empty; expected one record {}", path, expected.columns));
  reader.expect_columns(4 + expected.coefficients, expected.columns);
  Camera camera;
  camera.width = width;
  camera.height = height;
  camera.distortion = model;
  camera.pinhole = {reader.number(0, "fx"), reader.number(1, "fy"), reader.number(2, "cx"), reader.number(3, "cy")};
  if (!(camera.pinhole.fx > 0.0 && camera.pinhole.fy > 0.0)) {
    reader.fail(fmt::format("the focal lengths are {} and {}; expected > 0 px", camera.pinhole.fx, camera.pinhole.fy));
  }
  for (std::size_t i = 0; i < expected.coefficients; ++i) {
    camera.coefficients[static_cast<Eigen::Index>(i)] = reader.number(4 + i, "a lens coefficient");
  }
  if (reader.next()) reader.fail("a second record; expected one camera a file");
  return camera;
}

std::string format_calib(const Camera& camera) {
  const bool pinhole = camera.distortion == DistortionModel::none;
  const Layout written = layout(pinhole ? DistortionModel::radial_tangential : camera.distortion);
  const PinholeCamera& p = camera.pinhole;
  std::string text = fmt::format("{} {} {} {}", p.fx, p.fy, p.cx, p.cy);
  for (std::size_t i = 0; i < written.coefficients; ++i) {
    text += fmt::format(" {}", pinhole ? 0.0 : camera.coefficients[static_cast<Eigen::Index>(i)]);
  }
  return text + "\n";
}

}  // namespace evbench
