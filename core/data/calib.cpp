#include "core/data/calib.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "core/data/calibration_fields.hpp"
#include "core/io/text_reader.hpp"
#include "core/support/error.hpp"

namespace evbench {
namespace {

constexpr std::size_t kPinhole = 4;  // fx fy cx cy

bool is_yaml(const TextReader& reader) {
  return reader.text().starts_with("---") || reader.text().find_first_of(":{") != std::string::npos;
}

struct Coefficients {
  std::size_t count;
  const char* columns;
};

/// The columns with all coefficients of a lens model.
Coefficients layout(DistortionModel model) {
  switch (model) {
    case DistortionModel::radial_tangential: return {9, "fx fy cx cy k1 k2 p1 p2 k3"};
    case DistortionModel::equidistant: return {8, "fx fy cx cy k1 k2 k3 k4"};
    case DistortionModel::none: break;
  }
  return {4, "fx fy cx cy"};
}

}  // namespace

Camera read_calib(const std::string& path, int width, int height, DistortionModel model, const std::string& camera) {
  TextReader reader(path);
  const Coefficients full = layout(model);
  if (!reader.next()) {
    throw InputError(fmt::format("{}: is empty; expected one record {}, or YAML", path, full.columns));
  }
  if (reader.text().starts_with('<')) {
    reader.fail(fmt::format("is XML, as DV writes calibrations; expected one record {}, or YAML", full.columns));
  }
  if (is_yaml(reader)) return yaml_camera(Field::read_yaml(path), camera, {width, height, model});
  const std::size_t count = reader.columns().size();
  if (count < kPinhole || model == DistortionModel::none) reader.expect_columns(full.count, full.columns);
  std::vector<double> numbers;
  for (std::size_t i = 0; i < count; ++i) {
    constexpr std::array kNames{"fx", "fy", "cx", "cy", "a lens coefficient"};
    numbers.push_back(reader.number(i, kNames[std::min(i, kPinhole)]));
  }
  const std::string place = reader.place();
  if (reader.next()) reader.fail("a second record; expected one camera a file");
  return checked_camera(place, {numbers.begin(), numbers.begin() + kPinhole}, model,
                        {numbers.begin() + kPinhole, numbers.end()}, width, height);
}

std::string format_calib(const Camera& camera) {
  const bool pinhole = camera.distortion == DistortionModel::none;
  const Coefficients written = layout(pinhole ? DistortionModel::radial_tangential : camera.distortion);
  const PinholeCamera& p = camera.pinhole;
  std::string text = fmt::format("{} {} {} {}", p.fx, p.fy, p.cx, p.cy);
  for (std::size_t i = 0; i < written.count - kPinhole; ++i) {
    text += fmt::format(" {}", pinhole ? 0.0 : camera.coefficients[static_cast<Eigen::Index>(i)]);
  }
  return text + "\n";
}

}  // namespace evbench
