#include "frontends/haste/tracking/difference.hpp"

namespace evbench::haste {

namespace {

/// What Σ m² gains when an event adds its weights to four cells of a model.
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
    model_of_[h] = static_cast<std::uint8_t>(h);
    make_model(h, input);
  }
  compare(input);
}

void Difference::change_to(std::size_t h, const ScoringInput& input) {
  footprints_ = HypothesisFootprints(input.grid.angle);
  const auto former_models = model_of_;
  const Lanes<Double4> former_squares = squares_;
  std::array<bool, kHypotheses> kept{}, known{};
  for (std::size_t i = 0; i < kHypotheses; ++i) {
    const std::size_t former = hypothesis_at(kSteps[h], kSteps[i]);
    if (former == kHypotheses) continue;
    known[i] = true;
    kept[former_models[former]] = true;
    model_of_[i] = former_models[former];
    squares_.quads[i / 4][i % 4] = former_squares.quads[former / 4][former % 4];
  }
  std::uint8_t free = 0;
  for (std::size_t i = 0; i < kHypotheses; ++i) {
    if (known[i]) continue;
    while (kept[free]) ++free;
    model_of_[i] = free++;
    make_model(i, input);
  }
  compare(input);
}

void Difference::make_model(std::size_t h, const ScoringInput& input) {
  Model& model = (*models_)[model_of_[h]];
  model.fill(0);
  Double4 square{};
  for (int slot = 0; slot < kWindowSize; ++slot) {
    const int place = input.place(input.window.slot(slot));
    square += footprints_.visit(h, place, [&](int cell, Int4 weights) {
      return __builtin_convertvector(add_event(&model[index(cell)], weights), Double4);
    });
  }
  squares_.quads[h / 4][h % 4] = square[0] + square[1] + square[2] + square[3];
}

void Difference::set_template(const Template& learnt) {
  template_ = QuantisedTemplate(learnt);
  template_square_ = 0.0;
  for (const int cell : template_.cells()) template_square_ += static_cast<double>(cell) * cell;
}

void Difference::compare(const ScoringInput& input) {
  set_template(input.learnt);
  products_ = {};
  if (follow_template_) {
    for (std::size_t h = 0; h < kHypotheses; ++h) {
      const Model& model = (*models_)[model_of_[h]];
      double sum = 0.0;
      for (std::size_t i = 0; i < model.size(); ++i) sum += static_cast<double>(template_.cells()[i]) * model[i];
      products_.quads[h / 4][h % 4] = sum;
    }
  } else {
    for (int slot = 0; slot < kWindowSize; ++slot) {
      samples_[index(slot)] = template_.sample(footprints_, input.place(input.window.slot(slot)));
      const Lanes<Double4> sampled = to_double(samples_[index(slot)]);
      for (std::size_t i = 0; i < 3; ++i) products_.quads[i] += sampled.quads[i];
    }
  }
  score();
}

void Difference::update(int slot, const Event& replaced, const ScoringInput& input) {
  const int newest = input.place(input.window.slot(slot)), oldest = input.place(replaced);
  const auto change_models = [&](int place, auto change) {
    return to_double(sums_of_hypotheses([&](std::size_t h) {
      return footprints_.visit(h, place, [&](int cell, Int4 weights) -> Int4 {
        return change(&(*models_)[model_of_[h]][index(cell)], weights);
      });
    }));
  };
  const Lanes<Double4> gained = change_models(newest, add_event), lost = change_models(oldest, remove_event);
  for (std::size_t i = 0; i < 3; ++i) squares_.quads[i] += gained.quads[i] - lost.quads[i];
  if (follow_template_) {
    compare(input);
    return;
  }
  const Lanes<Int4> sampled = template_.sample(footprints_, newest);
  Lanes<Int4>& former = samples_[index(slot)];
  for (std::size_t i = 0; i < 3; ++i) {
    products_.quads[i] += __builtin_convertvector(sampled.quads[i] - former.quads[i], Double4);
  }
  former = sampled;
  score();
}

void Difference::score() {
  constexpr double kTemplate = QuantisedTemplate::kTemplateUnit;
  for (std::size_t i = 0; i < 3; ++i) {
    scores_.quads[i] =
        2.0 * kTemplate * products_.quads[i] - kTemplate * kTemplate * squares_.quads[i] - template_square_;
  }
  scores_.quads[2][3] = scores_.quads[0][0];
}

}  // namespace evbench::haste
