#include "frontends/poisson/patch.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>

namespace evbench::poisson {
namespace {

constexpr double kSmoothing = 0.8;  // [px] standard deviation of an event's place
constexpr int kWide = 4;            // cells that an event enters, along each axis

/// Weights of the cells around a place, by its fraction of a cell.
class Kernel {
 public:
  using Weights = std::array<float, kWide>;
  Kernel() {
    for (int i = 0; i < kSteps; ++i) {
      std::array<double, kWide> weights;
      double sum = 0.0;
      for (int k = 0; k < kWide; ++k) {
        const double distance = (k - 1 - (i + 0.5) / kSteps) / kSmoothing;
        sum += weights[index(k)] = std::exp(-0.5 * distance * distance);
      }
      for (int k = 0; k < kWide; ++k) weights_[index(i)][index(k)] = static_cast<float>(weights[index(k)] / sum);
    }
  }
  const Weights& at(double fraction) const { return weights_[index(static_cast<int>(fraction * kSteps))]; }

 private:
  static constexpr int kSteps = 32;
  std::array<Weights, kSteps> weights_;
};

}  // namespace

Patch::Patch(double radius)
    : radius_(radius),
      reach_(static_cast<int>(std::ceil(radius)) + kWide),
      side_(2 * reach_ + 1),
      area_(M_PI * radius * radius),
      cells_(index(side_ * side_)),
      on_(cells_.size()),
      off_(cells_.size()) {}

void Patch::move(const Vector2& direction, double way, double memory) {
  constexpr double kHeavy = 1e6;
  weight_ *= std::exp(way / memory);
  if (weight_ > kHeavy) {
    const auto scale = static_cast<float>(1.0 / weight_);
    for (Cell& cell : cells_) cell = {scale * cell.x, scale * cell.y, scale * cell.count, 0.0F};
    M_ /= weight_;
    way_ /= weight_;
    count_ /= weight_;
    weight_ = 1.0;
  }
  M_ += weight_ * way * direction * direction.transpose();
  way_ += weight_ * way;
}

void Patch::add(const Vector2& place, bool on, const Vector2& direction) {
  static const Kernel kernel;
  const double x = place.x() + reach_, y = place.y() + reach_;
  if (!(x >= 1.0 && y >= 1.0 && x < side_ - 3 && y < side_ - 3)) return;
  const int left = static_cast<int>(x), top = static_cast<int>(y);
  const Kernel::Weights &across = kernel.at(x - left), &down = kernel.at(y - top);
  const double sign = on ? -weight_ : weight_;
  const auto bx = static_cast<float>(sign * direction.x()), by = static_cast<float>(sign * direction.y());
  const auto one = static_cast<float>(weight_);
  for (int j = 0; j < kWide; ++j) {
    Cell* const row = &cells_[index((top + j - 1) * side_ + left - 1)];
    for (int i = 0; i < kWide; ++i) {
      const float w = across[index(i)] * down[index(j)];
      row[i].x += w * bx;
      row[i].y += w * by;
      row[i].count += w * one;
    }
  }
  count_ += weight_;
}

Patch::Slope Patch::mean_slope() const {
  Slope sum;
  double mass = 0.0;
  const int farthest = static_cast<int>(radius_);
  for (int j = -farthest; j <= farthest; ++j) {
    const double reach = std::sqrt(radius_ * radius_ - j * j);
    for (const std::vector<float>* rates : {&on_, &off_}) {
      const float* const row = &(*rates)[index((j + reach_) * side_ + reach_)];
      for (int i = -static_cast<int>(reach); i <= static_cast<int>(reach); ++i) {
        const double x = 0.5F * (row[i + 1] - row[i - 1]), y = 0.5F * (row[i + side_] - row[i - side_]);
        sum.x += x;
        sum.y += y;
        sum.turning += x * j - y * i;
        sum.growing += x * i + y * j;
        mass += row[i] + noise_;
      }
    }
  }
  if (!(mass > 0.0)) return {};
  return {sum.x / mass, sum.y / mass, sum.turning / mass, sum.growing / mass};
}

void Patch::look(const Vector2& direction, const Shares& shares) {
  constexpr double kUnknown = 1.0;  // [px] of way along a direction, before what it shows counts
  const double way = std::max(way_, 1e-9 * weight_);
  const double polarities = shares.polarity ? 0.5 : 1.0;
  const double mean = std::max(polarities * count_ / (way * area_), 1e-9);
  const Vector2 h = (M_ + weight_ * kUnknown * Matrix2::Identity()).inverse() * direction / mean;
  const auto hx = static_cast<float>(h.x()), hy = static_cast<float>(h.y());
  const auto any = static_cast<float>(polarities * shares.any_direction / (way * mean));
  noise_ = static_cast<float>(shares.noise);
  for (std::size_t i = 0; i < cells_.size(); ++i) {
    const float along = hx * cells_[i].x + hy * cells_[i].y, rest = any * cells_[i].count;
    on_[i] = std::max(shares.polarity ? -along : std::abs(along), 0.0F) + rest;
    off_[i] = std::max(shares.polarity ? along : std::abs(along), 0.0F) + rest;
  }
}

}  // namespace evbench::poisson
