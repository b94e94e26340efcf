#pragma once

#include <map>
#include <optional>
#include <span>

#include "core/data/track.hpp"

namespace evbench::str {

/// A map of dots on a plane, to predict the image positions of dots that are out of view. The dots in view give the
/// homography from the plane to the image. Where these do not lie on a plane, there is no prediction.
class PlaneMap {
 public:
  struct Seen {
    TrackId track;
    Vector2 pixel;
  };

  /// Estimates the homography from the dots in view at one time, and adds new dots to the map.
  void update(std::span<const Seen> dots);

  /// The current image position of a dot in the map [px]; none where it is not known.
  std::optional<Vector2> pixel(TrackId track) const;

  void forget(TrackId track) { places_.erase(track); }

 private:
  std::map<TrackId, Vector2> places_;      ///< on the plane, in pixels of the first image
  std::optional<Matrix3> image_of_plane_;  ///< now
};

}  // namespace evbench::str
