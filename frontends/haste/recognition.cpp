#include "frontends/haste/recognition.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

#include "frontends/haste/tracking/alignment.hpp"

namespace evbench::haste {
namespace {

constexpr int kStep = 2;             ///< [px] between positions in the first pass
constexpr int kTurn = 3;             ///< steps of angle between orientations
constexpr int kTurns = 3;            ///< orientations to either side
constexpr std::size_t kBest = 3;     ///< templates that are then compared at all positions in between
constexpr double kAmbiguous = 0.95;  ///< a score above this share of the best one counts as equally good

/// A position of a template, and its score.
struct Candidate {
  const KnownLook* known;
  GridState place;
  double likeness = 0.0;
};

/// The events around a position as patches turned by every requested angle: made once, for many templates.
class Sights {
 public:
  Sights(std::span<const Event> window, const GridState& about) : window_(window), about_(about) {}

  /// The position and orientation at which the template matches best.
  Candidate best(const KnownLook& known) {
    Candidate result{&known, about_};
    const int usual = static_cast<int>(std::lround(known.angle / kAngleStep / kTurn));
    for (int turn = usual - kTurns; turn <= usual + kTurns; ++turn) {
      for (const auto& [place, patch] : at(kTurn * turn)) {
        const double like = likeness(*known.look, patch);
        if (like > result.likeness) result = {&known, place, like};
      }
    }
    return result;
  }

 private:
  using Patches = std::vector<std::pair<GridState, Template>>;

  const Patches& at(int angle) {
    Patches& patches = by_angle_[angle];
    if (!patches.empty()) return patches;
    for (const int y : {-kStep, 0, kStep}) {
      for (const int x : {-kStep, 0, kStep}) {
        const GridState place = about_ + Step{x, y, angle};
        patches.emplace_back(place, sight(window_, place).patch);
      }
    }
    return patches;
  }

  std::span<const Event> window_;
  GridState about_;
  std::map<int, Patches> by_angle_;
};

}  // namespace

std::optional<Recognised> recognise(std::span<const KnownLook> looks, std::span<const Event> window,
                                    const Vector2& about, double similarity) {
  Sights sights(window, {static_cast<int>(std::lround(about.x())), static_cast<int>(std::lround(about.y())), 0});
  std::vector<Candidate> candidates;
  for (const KnownLook& known : looks) candidates.push_back(sights.best(known));
  const std::size_t count = std::min(kBest, candidates.size());
  const auto more_like = [](const Candidate& a, const Candidate& b) { return a.likeness > b.likeness; };
  std::partial_sort(candidates.begin(), candidates.begin() + static_cast<std::ptrdiff_t>(count), candidates.end(),
                    more_like);
  candidates.resize(count);
  for (Candidate& candidate : candidates) {
    const GridState middle = candidate.place;
    for (int y = 1 - kStep; y < kStep; ++y) {
      for (int x = 1 - kStep; x < kStep; ++x) {
        const GridState place = middle + Step{x, y, 0};
        const double like = align(*candidate.known->look, window, place).score;
        if (like > candidate.likeness) candidate = {candidate.known, place, like};
      }
    }
  }
  std::ranges::sort(candidates, more_like);
  if (candidates.empty() || candidates[0].likeness < similarity) return std::nullopt;
  if (count > 1 && candidates[1].likeness > kAmbiguous * candidates[0].likeness) return std::nullopt;
  const Candidate& best = candidates.front();
  return Recognised{best.known->track, Vector2(best.place.x, best.place.y), kAngleStep * best.place.angle};
}

}  // namespace evbench::haste
