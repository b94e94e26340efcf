#pragma once

#include <string>
#include <vector>

#include "bench/render/palette.hpp"
#include "core/data/track.hpp"

namespace evbench {

/// Feature tracks drawn over a picture: a dot where a track is, its last positions as a tail that fades.
class TrackOverlay {
 public:
  /// `observations` in time order; `tail` [s]: how long a tail is, and how long a track that has ended stays.
  TrackOverlay(std::vector<TrackObservation> observations, double tail)
      : observations_(std::move(observations)), tail_(tail) {}

  /// "0.100 to 2.000 s".
  std::string range_text() const;

  /// Over a picture that shows the sensor at time t [s], each pixel of it `scale` pixels wide. Is any track there?
  bool draw(double t, int scale, const Palette& palette, Picture& picture) const;

 private:
  std::vector<TrackObservation> observations_;
  double tail_;
};

/// A sensor's pixel in a picture that is enlarged by `scale`, in OpenCV's fixed point with kFractionBits.
inline constexpr int kFractionBits = 4;
cv::Point enlarged(const Vector2& pixel, int scale);

/// Neither the red nor the blue of events; neighbouring ids differ most.
Colour track_colour(TrackId track, const Palette& palette);

}  // namespace evbench
