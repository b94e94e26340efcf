#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/geometry/types.hpp"

namespace evbench::str {

/// Points of two kinds (polarities) in cells, to find the nearest point of a kind and the local shape of the points.
/// The cost of building and searching depends on the number of points, not on the area: empty cells are not touched.
class NeighbourGrid {
 public:
  /// Takes points; those that are not finite are left out. `cell`: a cell's side, in the points' unit. The last
  /// build's points are forgotten. Cells are larger where the points lie too far apart for four million of them.
  void build(std::span<const float> x, std::span<const float> y, std::span<const float> time,
             std::span<const std::uint8_t> kind, float cell);

  struct Neighbour {
    std::uint32_t point = 0;  ///< index among those given to build()
    float squared = 0.0F;     ///< distance²
    std::uint32_t cell = 0;   ///< for surroundings()
  };
  /// The nearest point of a kind that is less than `gate` away; none where there is none.
  std::optional<Neighbour> nearest(float x, float y, std::uint8_t kind, float gate) const;

  /// The local shape of the points of one kind, in a cell and those around it.
  struct Surroundings {
    Eigen::Vector2f mean;  ///< of the points
    float time = 0.0F;     ///< mean
    /// noise² (Σ + noise² I)⁻¹ of their covariance Σ: the weight of a distance from the mean in each direction. About
    /// 1 across a sharp edge, small along it; small in all directions where points lie everywhere.
    Eigen::Matrix2f weight;
  };
  /// Computed once a build and cell. `noise` is the same for all cells of a build.
  const Surroundings& surroundings(std::uint32_t cell, float noise);

 private:
  struct Cell {
    std::uint32_t build = 0;  ///< the build that it is of; of another one: it is empty
    std::uint32_t begin = 0, count = 0;
    std::uint32_t known = 0;  ///< the build of which surroundings_ has it
  };
  struct Point {
    float x, y, time;
    std::uint32_t index;
  };

  std::uint32_t cell_of(int column, int row, std::uint8_t kind) const {
    return static_cast<std::uint32_t>(2 * (row * columns_ + column)) + kind;
  }
  std::span<const Point> points(std::uint32_t cell) const {
    const Cell& c = cells_[cell];
    if (c.build != build_) return {};
    return {points_.data() + c.begin, c.count};
  }
  Surroundings look_around(std::uint32_t cell, float noise) const;

  float left_ = 0.0F, top_ = 0.0F, side_ = 1.0F, per_side_ = 1.0F;
  int columns_ = 0, rows_ = 0;
  std::uint32_t build_ = 0;
  std::vector<Cell> cells_;
  std::vector<std::uint32_t> occupied_;
  std::vector<std::uint32_t> cell_of_point_;
  std::vector<Point> points_;               ///< by cells
  std::vector<Surroundings> surroundings_;  ///< by cells
};

}  // namespace evbench::str
