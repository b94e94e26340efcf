#include "frontends/str/dots/plane_map.hpp"

#include <Eigen/LU>
#include <opencv2/calib3d.hpp>
#include <vector>

namespace evbench::str {

void PlaneMap::update(std::span<const Seen> dots) {
  constexpr std::size_t kLeast = 6;
  constexpr double kTolerance = 2.0;  // [px]
  constexpr double kOnPlane = 0.7;    // share of the dots that must agree
  image_of_plane_.reset();
  if (places_.empty()) {
    if (dots.size() < kLeast) return;
    for (const Seen& dot : dots) places_[dot.track] = dot.pixel;
  }
  std::vector<cv::Point2d> plane, image;
  for (const Seen& dot : dots) {
    const auto place = places_.find(dot.track);
    if (place == places_.end()) continue;
    plane.emplace_back(place->second.x(), place->second.y());
    image.emplace_back(dot.pixel.x(), dot.pixel.y());
  }
  if (plane.size() < kLeast) return;
  std::vector<std::uint8_t> agrees;
  const cv::Mat found = cv::findHomography(plane, image, cv::RANSAC, kTolerance, agrees);
  if (found.empty() || cv::countNonZero(agrees) < kOnPlane * static_cast<double>(plane.size())) return;
  Matrix3 H;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) H(row, column) = found.at<double>(row, column);
  }
  if (!H.allFinite() || !(std::abs(H.determinant()) > 1e-12)) return;
  image_of_plane_ = H;
  const Matrix3 back = H.inverse();
  for (const Seen& dot : dots) places_.try_emplace(dot.track, (back * dot.pixel.homogeneous()).hnormalized());
}

std::optional<Vector2> PlaneMap::pixel(TrackId track) const {
  const auto place = places_.find(track);
  if (!image_of_plane_ || place == places_.end()) return std::nullopt;
  const Vector3 p = *image_of_plane_ * place->second.homogeneous();
  if (!(std::abs(p.z()) > 1e-9)) return std::nullopt;
  return Vector2(p.hnormalized());
}

}  // namespace evbench::str
