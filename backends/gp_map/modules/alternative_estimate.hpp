#pragma once

#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "backends/gp_map/smoother.hpp"

namespace evbench::gp_map {

/// Initial structure of the landmarks that came into view recently.
enum class StructureHypothesis {
  frontal_plane,  ///< parallel to the image: no assumption about near and far
  dual_plane,     ///< normal to the estimated motion: the structure in the other solution of a moving plane
};

/// States from an oldest to a newest one, both included.
struct StateRange {
  int oldest = 0, newest = 0;
};

/// An alternative estimate of the recent part.
struct AlternativeEstimate {
  int first = 0;                                   ///< first state that it changes
  std::vector<ControlState> states;                ///< from there on, up to the newest one of the search
  std::vector<std::pair<int, Vector3>> landmarks;  ///< landmarks that came into view there, world frame [units]
  double advantage = 0.0;                          ///< by which its cost, ½ Σ ρ, is lower
  int landmark_count = 0;                          ///< number of landmarks of the searched problem

  /// Makes it the smoother's estimate. Later states are moved along, and so are landmarks that came into view after it
  /// or were added to the smoother since the search. Not for an smoother in which the state before the first one has
  /// been marginalised.
  void place_in(Smoother& smoother) const;
};

/// Searches a better alternative estimate of the recent part of a problem.
///
/// The image of a moving plane has two solutions, in which the plane's normal and the direction of translation are
/// exchanged (Longuet-Higgins, "The visual ambiguity of a moving plane", 1984). Only a change of the direction shows
/// which one is true. If most of the view is replaced within a second, new landmarks can support each other and the
/// motion in the wrong solution: it may have had the lower cost when they were few, Gauss-Newton steps do not lead out
/// of it, and within another second the scale is lost.
///
/// So the newest part of the problem, over a time in which most of the view has been replaced, is estimated once more
/// by itself, with older landmarks held and new landmarks beginning on another plane. Then both estimates are solved.
/// The problem of a tentative map is estimated again as a whole, held by the first pose, the scale and the landmarks'
/// priors, because its initial map was the best one for a few tenths of a second only. The search takes as long as many
/// updates, so it is done in shares.
class AlternativeSearch {
 public:
  /// Begins a search in the newest part of these states, the oldest of which must be the oldest one that is not
  /// marginalised; or in everything, if the map is tentative, nothing has been marginalised and states are few. None if
  /// fewer than `enough` landmarks are new, or if the new ones lie behind the camera. For a part also none if it
  /// reaches back to the oldest state, if fewer than `enough` landmarks are older, or if most landmarks of its newest
  /// interval are older.
  static std::optional<AlternativeSearch> begin(const FactorGraph& graph, const StateRange& states, int enough,
                                                StructureHypothesis hypothesis, bool tentative = false);

  /// Does a bounded share of the work. False when the search has ended.
  bool run_share();

  /// The result at the end: none unless the cost of the alternative is clearly lower.
  const std::optional<AlternativeEstimate>& found() const { return found_; }

 private:
  /// A plane through the middle of the new landmarks.
  struct Plane {
    Vector3 normal, point;
    double median_depth;  ///< of the new landmarks

    /// Initial position of a landmark: where a ray from p, of depth 1, meets the plane, within bounds.
    Vector3 place(const Vector3& p, const Vector3& ray) const;
  };
  static std::optional<Plane> assume_plane(StructureHypothesis hypothesis, const FactorGraph& problem,
                                           std::size_t fresh);

  AlternativeSearch(int first, int landmark_count, std::vector<int> fresh, FactorGraph problem, const Plane& plane);
  bool pass();
  void add_state(int k);
  void begin_solving();
  bool solve(Smoother& smoother);

  int first_;
  int landmark_count_;
  std::vector<int> fresh_;  ///< the new landmarks, which are the first ones here, by index in the whole problem
  FactorGraph problem_;     ///< begins with the state before the part, if there is one, which is held
  Plane plane_;
  int passes_;                           ///< in a share
  Smoother forward_;                     ///< passes through the problem, state by state, from the plane
  int newest_added_ = 0;                 ///< its newest state
  std::vector<int> in_engine_;           ///< its landmarks, by those of the problem
  std::optional<Smoother> alternative_;  ///< solved from the result of this pass
  std::optional<Smoother> present_;      ///< solved from the present estimate
  int iterations_ = 0;
  double cost_ = 0.0;
  std::optional<AlternativeEstimate> found_;
};

}  // namespace evbench::gp_map
