#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace evbench::gp_map {

/// What the modules count.
enum class Count {
  initial_maps,
  landmarks,                ///< that tracks became
  landmarks_without_depth,  ///< of these: at the scene's depth, until they show parallax
  misfits,                  ///< attempts to triangulate a track that no point fits
  leverage_bounded,         ///< times that a landmark got larger sigmas for its nearness
  outliers,                 ///< landmarks removed
  truncated,                ///< landmarks whose tracks drifted later
  noisier_tracks,           ///< times that a track got larger sigmas than most
  relaxations_tried,        ///< control states for which weaker priors were tried
  priors_relaxed,           ///< of these: for which one was kept
  searches,
  alternatives_accepted,
  reacquired,         ///< tracks that continue their landmark
  reacquired_as_new,  ///< tracks that became another landmark
  reassociations_rejected,
  scale_anchored_anew,
  updates,         ///< of the smoother, without those of searches and of the final estimate of a full history
  updates_damped,  ///< of these, those whose step would have raised the cost
  stages,          ///< that the updates redid
  count,
};

inline constexpr std::array<const char*, static_cast<std::size_t>(Count::count)> kCountNames = {
    "initial_maps",
    "landmarks",
    "landmarks_without_depth",
    "misfits",
    "leverage_bounded",
    "outliers",
    "truncated",
    "noisier_tracks",
    "relaxations_tried",
    "priors_relaxed",
    "searches",
    "alternatives_accepted",
    "reacquired",
    "reacquired_as_new",
    "reassociations_rejected",
    "scale_anchored_anew",
    "updates",
    "updates_damped",
    "stages"};

/// Of one map.
class Counters {
 public:
  std::int64_t& operator[](Count what) { return values_[static_cast<std::size_t>(what)]; }
  std::int64_t operator[](Count what) const { return values_[static_cast<std::size_t>(what)]; }

 private:
  std::array<std::int64_t, static_cast<std::size_t>(Count::count)> values_{};
};

}  // namespace evbench::gp_map
