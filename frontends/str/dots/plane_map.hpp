#pragma once

#include <map>
#include <optional>
#include <span>

#include "core/data/track.hpp"

namespace evbench::str {

/// Where dots lie on the plane that they are taken to be on, to know where those are that are out of view: the
/// homography from the plane to the image follows from the dots in view. Where these do not lie on a plane, it knows
/// nothing.
class PlaneMap {
 public:
  struct Seen {
    TrackId track;
    Vector2 pixel;
  };

  /// The dots in view at one time: finds the homography, and adds those that it has not yet.
  void update(std::span<const Seen> dots);

  /// Where a dot that has been seen is now [px]; none where it is not known.
  std::optional<Vector2> pixel(TrackId track) const;

  void forget(TrackId track) { places_.erase(track); }

 private:
  std::map<TrackId, Vector2> places_;      ///< on the plane, whose coordinates are the pixels of its beginning
  std::optional<Matrix3> image_of_plane_;  ///< now
};

}  // namespace evbench::str
