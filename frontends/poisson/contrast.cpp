#include "frontends/poisson/contrast.hpp"

#include <algorithm>
#include <vector>

#include "core/events/event_time.hpp"
#include "core/support/index.hpp"

namespace evbench::poisson {
namespace {

class Images {
 public:
  Images(std::span<const Event> events, const Vector2& centre, double radius)
      : events_(events), centre_(centre), reach_(static_cast<int>(radius) + 2), side_(2 * reach_ + 2) {}

  double sharpness(const Vector2& velocity) {
    const double t = 0.5 * (seconds(events_.front().t) + seconds(events_.back().t));
    pixels_.assign(index(2 * side_ * side_), 0.0F);
    for (const Event& event : events_) {
      const Vector2 place = Vector2(event.x, event.y) - centre_ - (seconds(event.t) - t) * velocity;
      const double x = place.x() + reach_, y = place.y() + reach_;
      if (!(x >= 0.0 && y >= 0.0 && x < side_ - 1 && y < side_ - 1)) continue;
      const int left = static_cast<int>(x), top = static_cast<int>(y);
      const auto fx = static_cast<float>(x - left), fy = static_cast<float>(y - top);
      float* const upper = &pixels_[index((event.on ? side_ * side_ : 0) + top * side_ + left)];
      float* const lower = upper + side_;
      upper[0] += (1.0F - fx) * (1.0F - fy);
      upper[1] += fx * (1.0F - fy);
      lower[0] += (1.0F - fx) * fy;
      lower[1] += fx * fy;
    }
    double sum = 0.0;
    for (const float pixel : pixels_) sum += double{pixel} * double{pixel};
    return sum;
  }

 private:
  std::span<const Event> events_;
  Vector2 centre_;
  int reach_, side_;
  std::vector<float> pixels_;  ///< OFF events' image, then ON events'
};

}  // namespace

Vector2 sharpest_velocity(std::span<const Event> events, const Vector2& centre, double radius) {
  constexpr int kFarthest = 4, kHalvings = 4;
  Vector2 best = Vector2::Zero();
  if (events.size() < 2 || events.front().t == events.back().t) return best;
  Images images(events, centre, radius);
  double highest = images.sharpness(best);
  double step = 2.0 / seconds(events.back().t - events.front().t);  // [px/s]: 2 px over the events' time
  const auto search = [&](const Vector2& about, int steps) {
    for (int j = -steps; j <= steps; ++j) {
      for (int i = -steps; i <= steps; ++i) {
        const Vector2 velocity = about + step * Vector2(i, j);
        const double sharpness = images.sharpness(velocity);
        if (!(sharpness > highest)) continue;
        highest = sharpness;
        best = velocity;
      }
    }
  };
  search(best, kFarthest);
  for (int k = 0; k < kHalvings; ++k) {
    step *= 0.5;
    search(Vector2(best), 1);
  }
  return best;
}

}  // namespace evbench::poisson
