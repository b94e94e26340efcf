#include "frontends/str/registration/neighbour_grid.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace evbench::str {
namespace {

constexpr std::uint32_t kNowhere = std::numeric_limits<std::uint32_t>::max();
constexpr double kMostCells = 4e6;

}  // namespace

void NeighbourGrid::build(std::span<const float> x, std::span<const float> y, std::span<const float> time,
                          std::span<const std::uint8_t> kind, float cell) {
  constexpr float kFar = std::numeric_limits<float>::max();
  float left = kFar, right = -kFar, top = kFar, bottom = -kFar;
  const auto is_finite = [&](std::size_t i) { return std::abs(x[i]) < 1e6F && std::abs(y[i]) < 1e6F; };
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (!is_finite(i)) continue;
    left = std::min(left, x[i]);
    right = std::max(right, x[i]);
    top = std::min(top, y[i]);
    bottom = std::max(bottom, y[i]);
  }
  ++build_;
  columns_ = rows_ = 0;
  if (left > right) return;
  const double area = static_cast<double>(right - left + cell) * static_cast<double>(bottom - top + cell);
  side_ = std::max(cell, static_cast<float>(std::sqrt(area / kMostCells)));
  per_side_ = 1.0F / side_;
  left_ = left;
  top_ = top;
  columns_ = static_cast<int>((right - left) * per_side_) + 1;
  rows_ = static_cast<int>((bottom - top) * per_side_) + 1;
  const auto cells = 2 * static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_);
  if (cells_.size() < cells) {
    cells_.resize(cells);
    surroundings_.resize(cells);
  }

  occupied_.clear();
  cell_of_point_.resize(x.size());
  std::uint32_t held = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (!is_finite(i)) {
      cell_of_point_[i] = kNowhere;
      continue;
    }
    const int column = std::min(static_cast<int>((x[i] - left_) * per_side_), columns_ - 1);
    const int row = std::min(static_cast<int>((y[i] - top_) * per_side_), rows_ - 1);
    const std::uint32_t id = cell_of(column, row, kind[i]);
    cell_of_point_[i] = id;
    Cell& c = cells_[id];
    if (c.build != build_) {
      c = {build_, 0, 0, 0};
      occupied_.push_back(id);
    }
    ++c.count;
    ++held;
  }
  std::uint32_t begin = 0;
  for (const std::uint32_t id : occupied_) {
    cells_[id].begin = begin;
    begin += std::exchange(cells_[id].count, 0);
  }
  points_.resize(held);
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (cell_of_point_[i] == kNowhere) continue;
    Cell& c = cells_[cell_of_point_[i]];
    points_[c.begin + c.count++] = {x[i], y[i], time[i], static_cast<std::uint32_t>(i)};
  }
}

std::optional<NeighbourGrid::Neighbour> NeighbourGrid::nearest(float x, float y, std::uint8_t kind, float gate) const {
  if (columns_ == 0) return std::nullopt;
  const float u = (x - left_) * per_side_, v = (y - top_) * per_side_;
  const float reach = gate * per_side_;
  if (!(u > -reach && v > -reach && u < static_cast<float>(columns_) + reach &&
        v < static_cast<float>(rows_) + reach)) {
    return std::nullopt;
  }
  const int column = static_cast<int>(std::floor(u)), row = static_cast<int>(std::floor(v));
  const int rings = static_cast<int>(std::ceil(reach));
  // No point in ring r + 1 is nearer than r cells plus the distance to the own cell's nearest side.
  const float fu = u - static_cast<float>(column), fv = v - static_cast<float>(row);
  const float inset = std::min(std::min(fu, 1.0F - fu), std::min(fv, 1.0F - fv));
  Neighbour best{0, gate * gate, kNowhere};
  const auto look_into = [&](int c, int r) {
    if (c < 0 || r < 0 || c >= columns_ || r >= rows_) return;
    const std::uint32_t id = cell_of(c, r, kind);
    for (const Point& p : points(id)) {
      const float dx = p.x - x, dy = p.y - y, squared = dx * dx + dy * dy;
      if (squared < best.squared) best = {p.index, squared, id};
    }
  };
  for (int ring = 0; ring <= rings; ++ring) {
    if (ring > 0) {
      const float least = (static_cast<float>(ring - 1) + inset) * side_;
      if (least * least >= best.squared) break;
    }
    for (int c = column - ring; c <= column + ring; ++c) {
      look_into(c, row - ring);
      if (ring > 0) look_into(c, row + ring);
    }
    for (int r = row - ring + 1; r < row + ring; ++r) {
      look_into(column - ring, r);
      look_into(column + ring, r);
    }
  }
  if (best.cell == kNowhere) return std::nullopt;
  return best;
}

const NeighbourGrid::Surroundings& NeighbourGrid::surroundings(std::uint32_t cell, float noise) {
  Cell& c = cells_[cell];
  if (c.known != build_) {
    c.known = build_;
    surroundings_[cell] = look_around(cell, noise);
  }
  return surroundings_[cell];
}

NeighbourGrid::Surroundings NeighbourGrid::look_around(std::uint32_t cell, float noise) const {
  const auto kind = static_cast<std::uint8_t>(cell % 2);
  const int column = static_cast<int>(cell / 2) % columns_, row = static_cast<int>(cell / 2) / columns_;
  const Eigen::Vector2f centre(left_ + (static_cast<float>(column) + 0.5F) * side_,
                               top_ + (static_cast<float>(row) + 0.5F) * side_);
  float n = 0.0F, sx = 0.0F, sy = 0.0F, st = 0.0F, sxx = 0.0F, sxy = 0.0F, syy = 0.0F;
  for (int r = std::max(row - 1, 0); r <= std::min(row + 1, rows_ - 1); ++r) {
    for (int c = std::max(column - 1, 0); c <= std::min(column + 1, columns_ - 1); ++c) {
      for (const Point& p : points(cell_of(c, r, kind))) {
        const float dx = p.x - centre.x(), dy = p.y - centre.y();
        n += 1.0F;
        sx += dx;
        sy += dy;
        st += p.time;
        sxx += dx * dx;
        sxy += dx * dy;
        syy += dy * dy;
      }
    }
  }
  Eigen::Matrix2f covariance;
  covariance << sxx - sx * sx / n, sxy - sx * sy / n, sxy - sx * sy / n, syy - sy * sy / n;
  covariance /= n;
  covariance += noise * noise * Eigen::Matrix2f::Identity();
  return {centre + Eigen::Vector2f(sx, sy) / n, st / n, noise * noise * covariance.inverse()};
}

}  // namespace evbench::str
