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

/// Whether the template is needed at changes of state only.
bool starred(Variant variant) {
  return variant == Variant::haste_correlation_star || variant == Variant::haste_difference_star;
}

constexpr int kMiddle = kWindowSize / 2;
constexpr int kMostWaiting = kMiddle;  // these are still in the window

bool weighted(Variant variant) { return variant == Variant::correlation || variant == Variant::haste_correlation; }

}  // namespace

float event_weight(Variant variant, int i) { return weighted(variant) ? gaussian_weights()[index(i)] : 1.0F; }

namespace {

/// Adds the window's events [begin, end) to the template, weighted by `part`.
void learn(Template& learnt, const ScoringInput& input, Variant variant, int begin, int end, double part) {
  const Footprints& footprints = Footprints::of(input.grid.angle);
  for (int i = begin; i < end; ++i) {
    const auto weight = static_cast<float>(part * double{event_weight(variant, i)});
    learnt.add(footprints, input.place(input.window.event(i)), weight);
  }
}

}  // namespace

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

/// An event in range.
Tracker::Update Tracker::take(const Event& event) {
  const Event replaced = window_.push(event);
  ++event_count_;
  if (!running_) {
    if (event_count_ < kWindowSize) return Update::collecting;
    start();
    return Update::started;
  }
  const std::size_t h = std::visit(
      [&](auto& scoring) {
        scoring.update(event, replaced, input());
        return chosen(scoring.raw(), options_.change_threshold);
      },
      scoring_);
  if (h != 0) change_to(h);
  // The window's middle event is added to the template. Where the template is not needed until the next change of
  // state, this is done later for several events together, while the template is in the cache.
  ++waiting_;
  if (!starred(options_.variant) || waiting_ == kMostWaiting) learn_waiting(kMiddle + 1);
  return h != 0 ? Update::changed : Update::regular;
}

/// Adds the waiting events, which lie before `end` in the window, to the template.
void Tracker::learn_waiting(int end) {
  learn(learnt_, input(), options_.variant, end - waiting_, end, options_.template_learning);
  waiting_ = 0;
}

Template Tracker::learnt_template() const {
  Template result = learnt_;
  learn(result, input(), options_.variant, kMiddle + 1 - waiting_, kMiddle + 1, options_.template_learning);
  return result;
}

void Tracker::start() {
  if (!template_given_) learn(learnt_, input(), options_.variant, 0, kWindowSize, 1.0);
  running_ = true;
  state_.t = window_.middle().t;
  std::visit([&](auto& scoring) { scoring.start(input()); }, scoring_);
  change_ = {-1, window_.newest().t, state_, state_, scores()};
}

void Tracker::change_to(std::size_t h) {
  change_ = {-1, window_.newest().t, state_, {}, scores()};
  learn_waiting(kMiddle);
  set_grid(grid_ + kSteps[h], window_.middle().t);
  change_.after = state_;
  std::visit([&](auto& scoring) { scoring.change_to(h, input()); }, scoring_);
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
