#include "bench/render/track_overlay.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <opencv2/imgproc.hpp>

namespace evbench {
namespace {

int thickness(int scale) { return std::max(1, (2 * scale + 1) / 3); }  // [px] of a tail
int radius(int scale) { return std::max(2, (4 * scale + 1) / 3); }     // [px] of a dot

}  // namespace

cv::Point enlarged(const Vector2& pixel, int scale) {
  const double limit = 1e6;  // observations may lie far outside
  const auto coordinate = [&](double value) {
    const double place = (std::clamp(value, -limit, limit) + 0.5) * scale - 0.5;
    return static_cast<int>(std::lround(std::ldexp(place, kFractionBits)));
  };
  return {coordinate(pixel.x()), coordinate(pixel.y())};
}

Colour track_colour(TrackId track, const Palette& palette) {
  constexpr double kGoldenRatio = 0.6180339887498949;
  const double turns = static_cast<double>(track) * kGoldenRatio;
  // Hues from 40 to 190 and from 265 to 335 degrees.
  double hue = 40.0 + 220.0 * (turns - std::floor(turns));
  if (hue > 190.0) hue += 75.0;
  const bool dark = palette.background[1] < 128;
  cv::Mat3f colour(1, 1, cv::Vec3f(static_cast<float>(hue), dark ? 0.75F : 1.0F, dark ? 1.0F : 0.68F));
  cv::cvtColor(colour, colour, cv::COLOR_HSV2BGR);
  Colour result;
  for (int i = 0; i < 3; ++i) result[i] = cv::saturate_cast<std::uint8_t>(255.0F * colour(0, 0)[i]);
  return result;
}

std::string TrackOverlay::range_text() const {
  if (observations_.empty()) return "nowhere";
  return fmt::format("{:.3f} to {:.3f} s", observations_.front().t, observations_.back().t);
}

bool TrackOverlay::draw(double t, int scale, const Palette& palette, Picture& picture) const {
  const auto first = std::ranges::upper_bound(observations_, t - tail_, {}, &TrackObservation::t);
  const auto last = std::ranges::upper_bound(observations_, t, {}, &TrackObservation::t);
  std::map<TrackId, std::vector<const TrackObservation*>> tracks;
  for (auto o = first; o < last; ++o) tracks[o->track].push_back(&*o);
  for (const auto& [id, positions] : tracks) {
    const Colour colour = track_colour(id, palette);
    // Rimmed with the background, so that it stands out from the events.
    for (const bool rim : {true, false}) {
      for (std::size_t i = 1; i < positions.size(); ++i) {
        const double age = (t - positions[i]->t) / tail_;
        cv::line(picture, enlarged(positions[i - 1]->pixel, scale), enlarged(positions[i]->pixel, scale),
                 scalar(rim ? palette.background : blend(colour, palette.background, 0.7 * age)),
                 thickness(scale) + (rim ? 2 : 0), cv::LINE_AA, kFractionBits);
      }
      cv::circle(picture, enlarged(positions.back()->pixel, scale), (radius(scale) + (rim ? 1 : 0)) << kFractionBits,
                 scalar(rim ? palette.background : colour), cv::FILLED, cv::LINE_AA, kFractionBits);
    }
  }
  return !tracks.empty();
}

}  // namespace evbench
