#include "eval/track_scores.hpp"

#include <array>
#include <map>
#include <optional>
#include <vector>

#include "core/plugin/exchange.hpp"
#include "eval/quantile.hpp"

namespace evbench {
namespace {

struct Age {
  const char *alive, *error;
  double seconds;
};
constexpr std::array kAges = {Age{"after_100ms", "at_100ms", 0.1}, Age{"after_500ms", "at_500ms", 0.5},
                              Age{"after_1s", "at_1s", 1.0}};
constexpr double kDrift = 3.0;      // [px]
constexpr double kLate = 0.05;      // [s] after an age, that an observation may be of it
constexpr double kInterval = 0.01;  // [s] at least, between two observations that count

/// A track from its beginning, or its re-association, to its end.
struct Piece {
  double from, to;                   ///< [s] first and last observation
  std::optional<Vector3> point;      ///< seen where it begins
  double counted;                    ///< [s] newest observation that counts
  std::size_t age = 0;               ///< the next one of kAges
  std::optional<double> error = {};  ///< of that observation [px]
};

Json share(std::size_t part, std::size_t all) {
  return all == 0 ? Json() : Json(static_cast<double>(part) / static_cast<double>(all));
}

Json median_and_p90(const std::vector<double>& values) {
  if (values.empty()) return {{"median", nullptr}, {"p90", nullptr}};
  return {{"median", quantile_of(values, 0.5)}, {"p90", quantile_of(values, 0.9)}};
}

class Scorer {
 public:
  Scorer(const PointTruth& truth, double end) : truth_(truth), end_(end) {}

  void observe(const TrackObservation& z) {
    const auto [live, begins] = live_.try_emplace(z.track);
    Piece& piece = live->second;
    if (begins) {
      piece = {z.t, z.t, truth_.point(z.pixel, z.t), z.t};
      const auto [first, is_new] = first_points_.try_emplace(z.track, piece.point);
      if (!is_new && first->second) reassociate(*first->second, z);
      return;
    }
    piece.to = z.t;
    const bool of_age = piece.age < kAges.size() && z.t >= piece.from + kAges[piece.age].seconds;
    if (!piece.point || (!of_age && z.t < piece.counted + kInterval)) return;
    const std::optional<Vector2> pixel = truth_.pixel(*piece.point, z.t);
    if (!pixel) return;
    piece.counted = z.t;
    piece.error = (z.pixel - *pixel).norm();
    ++counted_;
    far_ += *piece.error > kDrift ? 1 : 0;
    for (; piece.age < kAges.size() && z.t >= piece.from + kAges[piece.age].seconds; ++piece.age) {
      if (z.t <= piece.from + kAges[piece.age].seconds + kLate) errors_[piece.age].push_back(*piece.error);
    }
  }

  void end(TrackId track) {
    const auto live = live_.find(track);
    if (live == live_.end()) return;
    finish(live->second);
    live_.erase(live);
  }

  Json scores() {
    for (const auto& [track, piece] : live_) finish(piece);
    live_.clear();
    Json alive = Json::object(), errors = Json::object();
    for (std::size_t i = 0; i < kAges.size(); ++i) {
      alive[kAges[i].alive] = share(alive_[i], could_[i]);
      errors[kAges[i].error] = median_and_p90(errors_[i]);
    }
    return {{"pieces", lives_.size()},
            {"life_s", median_and_p90(lives_)},
            {"alive", std::move(alive)},
            {"error_px", std::move(errors)},
            {"beyond_3px", share(far_, counted_)},
            {"drifting", share(drifting_, with_error_)},
            {"reassociated", {{"right", right_}, {"wrong", wrong_}}}};
  }

 private:
  void reassociate(const Vector3& point, const TrackObservation& z) {
    const std::optional<Vector2> pixel = truth_.pixel(point, z.t);
    ++(pixel && (z.pixel - *pixel).norm() <= kDrift ? right_ : wrong_);
  }

  void finish(const Piece& piece) {
    lives_.push_back(piece.to - piece.from);
    for (std::size_t i = 0; i < kAges.size(); ++i) {
      if (piece.from + kAges[i].seconds > end_) continue;
      ++could_[i];
      alive_[i] += lives_.back() >= kAges[i].seconds ? 1 : 0;
    }
    if (!piece.error) return;
    ++with_error_;
    drifting_ += *piece.error > kDrift ? 1 : 0;
  }

  const PointTruth& truth_;
  double end_;
  std::map<TrackId, Piece> live_;
  std::map<TrackId, std::optional<Vector3>> first_points_;
  std::vector<double> lives_;
  std::array<std::vector<double>, kAges.size()> errors_;
  std::array<std::size_t, kAges.size()> alive_{}, could_{};
  std::size_t counted_ = 0, far_ = 0, with_error_ = 0, drifting_ = 0, right_ = 0, wrong_ = 0;
};

}  // namespace

Json score_tracks(std::span<const TrackObservation> observations, std::span<const TrackEnd> ends,
                  const PointTruth& truth, double end) {
  Scorer scorer(truth, end);
  in_time_order(
      observations, ends, [&](const TrackObservation& z) { scorer.observe(z); },
      [&](const TrackEnd& track) { scorer.end(track.track); });
  return scorer.scores();
}

}  // namespace evbench
