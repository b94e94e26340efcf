#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace evbench::gp_map {

/// What the modules count.
enum class Count {
  initial_maps,
  initial_maps_rejected,
  landmarks,               ///< that tracks became
  landmarks_without_depth, ///< of these: at the scene's depth, until they show parallax
  misfits,                 ///< attempts to triangulate a track that no point fits
  leverage_bounded,        ///< landmarks
  outliers,                ///< landmarks removed
  truncated,               ///< landmarks whose tracks drifted later
  noisier_tracks,          ///< tracks that got larger sigmas than others
  priors_relaxed,          ///< control states
  searches,
  alternatives_accepted,
  reacquired,              ///< tracks that continue their landmark
  reacquired_as_new,       ///< tracks that became another landmark
  reassociations_rejected,
  scale_anchored_anew,
  count,
};

inline constexpr std::array<const char*, static_cast<std::size_t>(Count::count)> kCountNames = {
    "initial_maps",     "initial_maps_rejected", "landmarks",
    "landmarks_without_depth", "misfits",        "leverage_bounded",
    "outliers",         "truncated",             "noisier_tracks",
    "priors_relaxed",   "searches",              "alternatives_accepted",
    "reacquired",       "reacquired_as_new",     "reassociations_rejected",
    "scale_anchored_anew"};

/// Of one run, over all its maps.
class Counters {
 public:
  std::int64_t& operator[](Count what) { return values_[static_cast<std::size_t>(what)]; }
  std::int64_t operator[](Count what) const { return values_[static_cast<std::size_t>(what)]; }

 private:
  std::array<std::int64_t, static_cast<std::size_t>(Count::count)> values_{};
};

}  // namespace evbench::gp_map
