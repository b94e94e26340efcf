#include "frontends/haste/tracking/tracker.hpp"

#include <cmath>

namespace evbench::haste {

namespace {

using Scoring = std::variant<StarCorrelation, WeightedCorrelation, Difference>;

Scoring make_scoring(Variant variant) {
  switch (variant) {
    case Variant::correlation: return WeightedCorrelation(true);
    case Variant::haste_correlation: return WeightedCorrelation(false);
    case Variant::haste_correlation_star: return StarCorrelation();
    case Variant::haste_difference: return Difference(true);
    case Variant::haste_difference_star: return Difference(false);
  }
  return StarCorrelation();
}

bool weighted(Variant variant) { return variant == Variant::correlation || variant == Variant::haste_correlation; }

}  // namespace

float event_weight(Variant variant, int i) { return weighted(variant) ? gaussian_weights()[index(i)] : 1.0F; }

Tracker::Tracker(const TrackerOptions& options, const TrackerState& seed)
    : options_(options),
      grid_{static_cast<int>(std::lround(seed.position.x())), static_cast<int>(std::lround(seed.position.y())),
            static_cast<int>(std::lround(seed.angle / kAngleStep))},
      remainder_(seed.position - Vector2(grid_.x, grid_.y)),
      angle_remainder_(seed.angle - kAngleStep * grid_.angle),
      state_(seed),
      scoring_(make_scoring(options.variant)) {}

Tracker::Tracker(const TrackerOptions& options, const TrackerState& seed, const Template& given)
    : Tracker(options, seed) {
  template_given_ = true;
  learnt_ = given;
}

Tracker::Update Tracker::push(const Event& event) {
  if (!in_range(event.x - grid_.x, event.y - grid_.y)) return Update::out_of_range;
  const Event replaced = window_.slot(window_.oldest_slot());
  const int slot = window_.push(event);
  ++event_count_;
  if (!running_) {
    if (event_count_ < kWindowSize) return Update::collecting;
    start();
    return Update::started;
  }
  const std::size_t h = std::visit(
      [&](auto& scoring) {
        scoring.update(slot, replaced, input());
        return chosen(scoring.raw(), options_.change_threshold);
      },
      scoring_);
  if (h != 0) change_to(h);
  learn(kWindowSize / 2, options_.template_learning);
  return h != 0 ? Update::changed : Update::regular;
}

/// The i-th event of the window, as much of it as `part` says.
void Tracker::learn(int i, double part) {
  const auto weight = static_cast<float>(part * double{event_weight(options_.variant, i)});
  learnt_.add(Footprints::of(grid_.angle), input().place(window_.event(i)), weight);
}

void Tracker::start() {
  if (!template_given_) {
    for (int i = 0; i < kWindowSize; ++i) learn(i, 1.0);
  }
  running_ = true;
  state_.t = window_.middle().t;
  std::visit([&](auto& scoring) { scoring.start(input()); }, scoring_);
  change_ = {-1, window_.newest().t, state_, state_, scores()};
}

void Tracker::change_to(std::size_t h) {
  change_ = {-1, window_.newest().t, state_, {}, scores()};
  set_grid(grid_ + kSteps[h], window_.middle().t);
  change_.after = state_;
  std::visit([&](auto& scoring) { scoring.change_to(h, input()); }, scoring_);
}

void Tracker::move_by(const Vector2& translation, double angle) {
  const Step step{static_cast<int>(std::lround(translation.x())), static_cast<int>(std::lround(translation.y())),
                  static_cast<int>(std::lround(angle / kAngleStep))};
  set_grid(grid_ + step, state_.t);
  if (running_) std::visit([&](auto& scoring) { scoring.start(input()); }, scoring_);
}

void Tracker::set_grid(const GridState& grid, std::int64_t t) {
  grid_ = grid;
  state_ = {t, Vector2(grid.x, grid.y) + remainder_, kAngleStep * grid.angle + angle_remainder_};
}

Scores Tracker::scores() const {
  if (!running_) return {};
  return std::visit([&](const auto& scoring) { return scaled(scoring.raw(), scoring.unit(input())); }, scoring_);
}

}  // namespace evbench::haste
