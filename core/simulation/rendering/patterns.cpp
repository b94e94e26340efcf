#include "core/simulation/rendering/patterns.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "core/support/error.hpp"
#include "core/support/index.hpp"

namespace evbench {
namespace {

constexpr int kShift = 6;  // binary places of the vertices that OpenCV draws
constexpr double kWhite = 235.0;

using Polygon = std::vector<Vector2>;

/// Vertices at equal angles, with the radii in turn.
Polygon star(const Vector2& centre, int vertices, const std::vector<double>& radii, double angle) {
  Polygon polygon;
  for (int i = 0; i < vertices; ++i) {
    const double a = angle + 2.0 * M_PI * i / vertices;
    polygon.push_back(centre + radii[index(i) % radii.size()] * Vector2(std::cos(a), std::sin(a)));
  }
  return polygon;
}

Polygon l_shape(const Vector2& centre, double radius, double angle) {
  const std::vector<Vector2> corners{{-0.6, -0.8}, {-0.1, -0.8}, {-0.1, 0.3}, {0.6, 0.3}, {0.6, 0.8}, {-0.6, 0.8}};
  Polygon polygon;
  for (const Vector2& corner : corners) polygon.push_back(centre + radius * (Eigen::Rotation2Dd(angle) * corner));
  return polygon;
}

void fill(cv::Mat& picture, const Polygon& polygon, double grey) {
  std::vector<cv::Point> vertices;
  for (const Vector2& vertex : polygon) {
    vertices.emplace_back(static_cast<int>(std::lround(std::ldexp(vertex.x(), kShift))),
                          static_cast<int>(std::lround(std::ldexp(vertex.y(), kShift))));
  }
  cv::fillPoly(picture, vertices, cv::Scalar(grey), cv::LINE_AA, kShift);
}

cv::Mat blank(int side) { return {side, side, CV_8U, cv::Scalar(kWhite)}; }

/// A place in each square of a grid, so that an object of this radius stays within the square.
std::vector<Vector2> places(int side, double square, double radius, Random& random) {
  std::vector<Vector2> result;
  const int count = std::max(1, static_cast<int>(side / square));
  const double room = static_cast<double>(side) / count, margin = std::min(radius, 0.5 * room);
  for (int row = 0; row < count; ++row) {
    for (int column = 0; column < count; ++column) {
      const double x = random.uniform(margin, room - margin), y = random.uniform(margin, room - margin);
      result.emplace_back(column * room + x, row * room + y);
    }
  }
  return result;
}

void find_corners(Pattern& pattern, double distance) {
  std::vector<cv::Point2f> corners;
  cv::goodFeaturesToTrack(pattern.picture, corners, 10000, 0.02, distance, {}, 5);
  for (const cv::Point2f& corner : corners) pattern.features.emplace_back(corner.x, corner.y);
}

}  // namespace

Pattern draw_dots(int side, double diameter, Random& random) {
  Pattern pattern{blank(side), places(side, 3.0 * diameter, 0.6 * diameter, random)};
  constexpr int kVertices = 48;
  for (const Vector2& centre : pattern.features) {
    fill(pattern.picture, star(centre, kVertices, {0.5 * diameter}, 0.0), 30.0);
  }
  return pattern;
}

Pattern draw_shapes(int side, double size, Random& random) {
  Pattern pattern{blank(side), {}};
  for (const Vector2& centre : places(side, 1.6 * size, 0.6 * size, random)) {
    const double radius = size * random.uniform(0.35, 0.55), angle = random.uniform(0.0, 2.0 * M_PI);
    const double grey = random.uniform(20.0, 90.0);
    switch (random.index(6)) {
      case 0: fill(pattern.picture, star(centre, 96, {radius}, 0.0), grey); break;
      case 1: fill(pattern.picture, star(centre, 3, {radius}, angle), grey); break;
      case 2: fill(pattern.picture, star(centre, 4, {radius}, angle), grey); break;
      case 3: fill(pattern.picture, star(centre, 6, {radius}, angle), grey); break;
      case 4: fill(pattern.picture, star(centre, 10, {radius, 0.45 * radius}, angle), grey); break;
      default: fill(pattern.picture, l_shape(centre, radius, angle), grey); break;
    }
  }
  find_corners(pattern, 0.2 * size);
  return pattern;
}

namespace {

constexpr double kLargestLeaf = 16.0;  // times the smallest

/// A leaf's diameter, times the smallest one's: density ~ diameter⁻³.
double leaf_diameter(Random& random) {
  return 1.0 / std::sqrt(1.0 - random.uniform() * (1.0 - 1.0 / (kLargestLeaf * kLargestLeaf)));
}

void add_leaf(cv::Mat& picture, const Vector2& centre, double diameter, Random& random) {
  const int vertices = 3 + static_cast<int>(random.index(3));
  const double radius = 0.5 * diameter, angle = random.uniform(0.0, 2.0 * M_PI);
  const std::vector<double> radii{radius, radius * random.uniform(0.6, 1.0), radius * random.uniform(0.8, 1.0)};
  fill(picture, star(centre, vertices, radii, angle), random.uniform(20.0, kWhite));
}

/// Leaves that cover `area` [px²] so many times on average. Mean area of a leaf by that density: ∫ d² d⁻³ / ∫ d⁻³
/// = 2 ln(largest) / (1 − largest⁻²) of the smallest one's.
int leaf_count(double area, double smallest, double times) {
  return static_cast<int>(times * area / (0.5 * smallest * smallest * 2.0 * std::log(kLargestLeaf)));
}

}  // namespace

Pattern draw_leaves(int side, double smallest, Random& random) {
  Pattern pattern{blank(side), {}};
  const int count = leaf_count(static_cast<double>(side) * side, smallest, 3.0);
  for (int i = 0; i < count; ++i) {
    const double diameter = smallest * leaf_diameter(random);
    add_leaf(pattern.picture, random.uniform2({0.0, 0.0}, {side, side}), diameter, random);
  }
  find_corners(pattern, smallest);
  return pattern;
}

Pattern draw_stripes(int side, double smallest, Random& random) {
  Pattern pattern{blank(side), {}};
  const double patch = 30.0 * smallest;
  const int count = std::max(4, static_cast<int>(4.0 * side * side / (patch * patch)));
  for (int i = 0; i < count; ++i) {
    const Vector2 centre = random.uniform2({0.0, 0.0}, {side, side});
    const double radius = patch * random.uniform(0.5, 1.0), angle = random.uniform(0.0, 2.0 * M_PI);
    const int left = std::max(0, static_cast<int>(centre.x() - radius)),
              top = std::max(0, static_cast<int>(centre.y() - radius));
    const cv::Rect part = cv::Rect(left, top, static_cast<int>(2.0 * radius) + 2, static_cast<int>(2.0 * radius) + 2) &
                          cv::Rect(0, 0, side, side);
    const Vector2 middle = centre - Vector2(left, top);  // in the part
    cv::Mat mask(part.size(), CV_8U, cv::Scalar(0)), stripes(part.size(), CV_8U, cv::Scalar(kWhite));
    const double turn = random.uniform(0.0, 2.0 * M_PI), inner = radius * random.uniform(0.7, 1.0);
    fill(mask, star(middle, 5, {radius, inner}, turn), 255.0);
    const Vector2 across(std::cos(angle), std::sin(angle)), along(-across.y(), across.x());
    for (double at = -radius; at < radius;) {
      const double width = smallest * random.uniform(1.0, 4.0);
      const Vector2 from = middle + at * across, to = from + width * across;
      const Vector2 half = radius * along;
      fill(stripes, {from - half, to - half, to + half, from + half}, random.uniform(20.0, kWhite));
      at += width;
    }
    stripes.copyTo(pattern.picture(part), mask);
  }
  find_corners(pattern, smallest);
  return pattern;
}

Pattern draw_bare(int side, double smallest, Random& random) {
  Pattern pattern{cv::Mat(side, side, CV_8U, cv::Scalar(random.uniform(90.0, 200.0))), {}};
  const double heap = 40.0 * smallest;  // diameter
  for (const Vector2& centre : places(side, 1.8 * heap, 0.5 * heap, random)) {
    const int count = leaf_count(0.25 * M_PI * heap * heap, smallest, 1.5);
    for (int i = 0; i < count; ++i) {
      const double radius = 0.5 * heap * std::sqrt(random.uniform()), angle = random.uniform(0.0, 2.0 * M_PI);
      const double diameter = smallest * leaf_diameter(random);
      add_leaf(pattern.picture, centre + radius * Vector2(std::cos(angle), std::sin(angle)), diameter, random);
    }
  }
  find_corners(pattern, smallest);
  return pattern;
}

Pattern draw_repeated(int side, double smallest, Random& random) {
  const int tile = std::clamp(static_cast<int>(25.0 * smallest), 8, side);
  const cv::Mat one = draw_leaves(tile, smallest, random).picture;
  Pattern pattern{{}, {}};
  const int times = (side + tile - 1) / tile;
  cv::Mat all;
  cv::repeat(one, times, times, all);
  pattern.picture = all(cv::Rect(0, 0, side, side)).clone();
  find_corners(pattern, smallest);
  return pattern;
}

Pattern read_picture(const std::string& path) {
  Pattern pattern;
  if (!std::filesystem::is_regular_file(path)) {
    throw InputError(fmt::format("{}: no such file; expected a picture", path));
  }
  pattern.picture = cv::imread(path, cv::IMREAD_GRAYSCALE);
  if (pattern.picture.empty()) {
    throw InputError(fmt::format("{}: can't be read as a picture; expected a PNG, JPEG, TIFF, ... file", path));
  }
  find_corners(pattern, 5.0);
  return pattern;
}

}  // namespace evbench
