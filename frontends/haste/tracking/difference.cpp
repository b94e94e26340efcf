#include "frontends/haste/tracking/difference.hpp"

#include <algorithm>

namespace evbench::haste {

namespace {

/// Of two patches: a sum of integers, so that its order is free.
double dot(const int* a, const int* b) {
  using Int8At [[gnu::vector_size(32), gnu::aligned(4), gnu::may_alias]] = int;
  using Double8 [[gnu::vector_size(64)]] = double;
  static_assert(kPatchCells % 8 == 0);
  Double8 sum{};
  for (int i = 0; i < kPatchCells; i += 8) {
    sum += __builtin_convertvector(*reinterpret_cast<const Int8At*>(a + i), Double8) *
           __builtin_convertvector(*reinterpret_cast<const Int8At*>(b + i), Double8);
  }
  return ((sum[0] + sum[1]) + (sum[2] + sum[3])) + ((sum[4] + sum[5]) + (sum[6] + sum[7]));
}

/// What Σ m² gains, before it is summed up, when an event adds its weights to four cells of a model.
Int4 add_event(int* cell, Int4 weights) {
  const Int4 before = Block<int>::load(cell), after = before + weights;
  Block<int>::store(cell, after);
  return weights * (before + after);
}

/// What it loses when they are taken away.
Int4 remove_event(int* cell, Int4 weights) {
  const Int4 before = Block<int>::load(cell), after = before - weights;
  Block<int>::store(cell, after);
  return weights * (before + after);
}

/// The hypothesis that is a step from another; none: kHypotheses.
std::size_t hypothesis_at(const Step& from, const Step& step) {
  std::size_t h = 0;
  while (h < kHypotheses && !(kSteps[h].x == from.x + step.x && kSteps[h].y == from.y + step.y &&
                              kSteps[h].angle == from.angle + step.angle)) {
    ++h;
  }
  return h;
}

}  // namespace

Difference::Difference(bool follow_template)
    : follow_template_(follow_template), models_(std::make_unique<std::array<Model, kHypotheses>>()) {}

void Difference::start(const ScoringInput& input) {
  footprints_ = HypothesisFootprints(input.grid.angle);
  for (std::size_t h = 0; h < kHypotheses; ++h) {
    model_of_[h] = (*models_)[h].data();
    make_model(h, input);
  }
  compare(input);
}

void Difference::change_to(std::size_t h, const ScoringInput& input) {
  footprints_ = HypothesisFootprints(input.grid.angle);
  const auto former_models = model_of_;
  const Lanes<Double4> former_squares = squares_;
  std::array<bool, kHypotheses> known{}, kept{};
  for (std::size_t i = 0; i < kHypotheses; ++i) {
    const std::size_t former = hypothesis_at(kSteps[h], kSteps[i]);
    if (former == kHypotheses) continue;
    known[i] = kept[former] = true;
    model_of_[i] = former_models[former];
    squares_.set(i, former_squares.of(former));
  }
  std::size_t free = 0;
  for (std::size_t i = 0; i < kHypotheses; ++i) {
    if (known[i]) continue;
    while (kept[free]) ++free;
    model_of_[i] = former_models[free++];
    make_model(i, input);
  }
  compare(input);
}

void Difference::make_model(std::size_t h, const ScoringInput& input) {
  int* model = model_of_[h];
  std::fill_n(model, kPatchCells, 0);
  Double4 square{};
  for (int slot = 0; slot < kWindowSize; ++slot) {
    const auto [cell, weights] = footprints_.of(h, input.place(input.window.slot(slot)));
    square += __builtin_convertvector(add_event(model + cell, weights), Double4);
  }
  squares_.set(h, square[0] + square[1] + square[2] + square[3]);
}

void Difference::compare(const ScoringInput& input) {
  const QuantisedTemplate compared(input.learnt);
  const int* cells = compared.cells().data();
  template_square_ = dot(cells, cells);
  if (follow_template_) {
    for (std::size_t h = 0; h < kHypotheses; ++h) products_.set(h, dot(cells, model_of_[h]));
  } else {
    samples_.make(footprints_, compared);
    products_ = samples_.sum(input);
  }
  score();
}

void Difference::update(const Event& newest, const Event& replaced, const ScoringInput& input) {
  const int place = input.place(newest), former = input.place(replaced);
  std::array<Int4, kHypotheses> gained;
  for (std::size_t h = 0; h < kHypotheses; ++h) {
    const auto arrives = footprints_.of(h, place), leaves = footprints_.of(h, former);
    gained[h] = add_event(model_of_[h] + arrives.first, arrives.weights);
    gained[h] -= remove_event(model_of_[h] + leaves.first, leaves.weights);
  }
  add(squares_, sums_of_hypotheses([&](std::size_t h) { return gained[h]; }));
  if (follow_template_) {
    compare(input);
    return;
  }
  add(products_, samples_.at(place) - samples_.at(former));
  score();
}

void Difference::score() {
  constexpr double kTemplate = QuantisedTemplate::kTemplateUnit;
  for (std::size_t i = 0; i < 3; ++i) {
    scores_.quads[i] =
        2.0 * kTemplate * products_.quads[i] - kTemplate * kTemplate * squares_.quads[i] - template_square_;
  }
  scores_.quads[2][3] = scores_.of(0);
}

}  // namespace evbench::haste
