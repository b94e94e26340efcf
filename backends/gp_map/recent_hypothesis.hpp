#pragma once

#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "backends/gp_map/engine/engine.hpp"

namespace evbench::gp_map {

/// Where all that came into view of late is supposed to lie, as a beginning.
enum class StructureHypothesis {
  frontal_plane,  ///< parallel to the image: nothing is supposed about what is near and what is far
  dual_plane,     ///< normal to how the camera seems to have moved: where the other explanation of a plane has it
  reversal,       ///< what seems near is far, and what seems far near, as when Necker's cube turns over
};

/// From an oldest to a newest one, both included.
struct StateRange {
  int oldest = 0, newest = 0;
};

/// Another explanation of what was seen of late.
struct RecentHypothesis {
  int first = 0;                                   ///< state from which on it says something else
  std::vector<ControlState> states;                ///< from there on, the newest it was looked for in last
  std::vector<std::pair<int, Vector3>> landmarks;  ///< those that came into view since, world frame [units]
  double advantage = 0.0;                          ///< by which its cost, ½ Σ ρ, is lower
  int landmarks_then = 0;                          ///< of the problem, as it was looked for

  /// Makes it the estimate; later states and the landmarks that came into view after it, or have been added to the
  /// engine since it was looked for, go along. Not for an engine in which the state before the first one has been
  /// marginalised.
  void place_in(Engine& engine) const;
};

/// The motion of a plane's image has two explanations, in which the plane's normal and the direction of translation
/// change places (Longuet-Higgins, "The visual ambiguity of a moving plane", 1984); only how the direction changes
/// tells which is true. Where most of what is in view is replaced within a second, new landmarks can hold each other
/// and the motion in the wrong one: it may have had the lower cost when they were few, Gauss-Newton steps don't lead
/// out of it, and within another second the scale is lost.
///
/// So the newest part of the problem, over a time in which most of what is in view has come into it and what was before
/// has gone, is gone through once more on its own, what was known before being held, with new landmarks beginning on
/// another plane; then both explanations are solved. Of a young map's problem, whose initial map is what explained a few
/// tenths of a second best, all is gone through, held by the first pose, the scale and the landmarks' priors. That
/// takes as long as many updates, so it is done in shares.
///
/// What has depth has another explanation, too, where little of it is in view and the camera has hardly moved: near and
/// far change places, and so do the ways to the left and to the right (Necker's reversal; Szeliski and Kang, "Shape
/// ambiguities in structure from motion", 1997).
class HypothesisSearch {
 public:
  /// Of the newest part of these states, the oldest of which is the oldest one that is being estimated, or, when the
  /// map is young, nothing has been marginalised and states are few, of everything. None where fewer than `enough`
  /// landmarks are new, and where what is new lies behind the camera; of a part none either where it reaches back to
  /// the oldest state, where fewer than `enough` landmarks were known before, and where most of those seen in its
  /// newest interval were.
  static std::optional<HypothesisSearch> begin(const FactorGraph& graph, const StateRange& states, int enough,
                                                StructureHypothesis supposed, bool young = false);

  /// Does a bounded share of the work. False when it has come to its end.
  bool go_on();

  /// At its end: nothing unless the other explanation's cost is clearly lower.
  const std::optional<RecentHypothesis>& found() const { return found_; }

 private:
  /// On a plane through the middle of what is new, or at a depth of its own.
  struct Beginning {
    Vector3 normal, point;
    double usual;                ///< depth
    std::vector<double> depths;  ///< of each landmark that is new, at its first sight; none: on the plane

    /// Of a landmark, where a ray from p, of depth 1, meets it, within bounds.
    Vector3 place(int landmark, const Vector3& p, const Vector3& ray) const;
  };
  static std::optional<Beginning> suppose(StructureHypothesis supposed, const FactorGraph& problem, std::size_t fresh);

  HypothesisSearch(int first, int landmarks_then, std::vector<int> fresh, FactorGraph problem, Beginning beginning);
  bool pass();
  void add_state(int k);
  void begin_solving();
  bool solve(Engine& engine);

  int first_;
  int landmarks_then_;
  std::vector<int> fresh_;  ///< landmarks of the whole problem: the first ones of this
  FactorGraph problem_;     ///< the state before the part first, if there is one, which is held
  Beginning beginning_;
  int passes_;                     ///< a share
  Engine through_;                 ///< goes through the problem from that beginning
  int gone_through_ = 0;           ///< its newest state
  std::vector<int> in_engine_;     ///< its landmarks, by those of the problem
  std::optional<Engine> other_;    ///< solved from where that ended
  std::optional<Engine> present_;  ///< solved from the present estimate
  int iterations_ = 0;
  double cost_ = 0.0;
  std::optional<RecentHypothesis> found_;
};

}  // namespace evbench::gp_map
