#include "frontends/haste/tracking/testing/plain_tracker.hpp"

namespace evbench::haste::testing {

namespace {

constexpr int kTemplateUnit = QuantisedTemplate::kTemplateUnit;

/// Calls visit(row, column, weight) for the four cells of a footprint.
template <class Visit>
void for_cells(const Footprint& footprint, Visit visit) {
  const auto row = index(footprint.cell / kPatchStride), column = index(footprint.cell % kPatchStride);
  visit(row, column, footprint.weights[0]);
  visit(row, column + 1, footprint.weights[1]);
  visit(row + 1, column, footprint.weights[2]);
  visit(row + 1, column + 1, footprint.weights[3]);
}

}  // namespace

Footprint PlainTracker::footprint_of(const Event& event, const GridState& grid) const {
  return footprint(event.x - grid.x, event.y - grid.y, grid.angle);
}

void PlainTracker::learn(const Event& event, double weight) {
  const Footprint place = footprint_of(event, grid_);
  if (!place.inside()) return;
  const double rounded = static_cast<float>(weight);
  for_cells(place, [&](std::size_t row, std::size_t column, int share) {
    float& cell = template_[row][column];
    cell = static_cast<float>(cell + rounded / kUnit * share);
  });
  mass_ += rounded;
}

PlainTracker::Patch<std::int64_t> PlainTracker::quantised_template() const {
  const auto scale = static_cast<float>(double{kWindowSize} * kUnit * kTemplateUnit / mass_);
  Patch<std::int64_t> result{};
  for (std::size_t row = 0; row < kPatchSize; ++row) {
    for (std::size_t column = 0; column < kPatchSize; ++column) {
      result[row][column] = static_cast<std::int64_t>(template_[row][column] * scale);
    }
  }
  return result;
}

float PlainTracker::sample(const Event& event, const GridState& grid) const {
  std::array<double, 4> parts{};
  std::size_t i = 0;
  for_cells(footprint_of(event, grid), [&](std::size_t row, std::size_t column, int weight) {
    parts[i++] = double{template_[row][column]} * weight;
  });
  return static_cast<float>((parts[0] + parts[2]) + (parts[1] + parts[3]));
}

PlainTracker::Patch<std::int64_t> PlainTracker::difference(const GridState& grid,
                                                           const Patch<std::int64_t>& scaled_template) const {
  Patch<std::int64_t> result = scaled_template;
  for (const Event& event : window_) {
    for_cells(footprint_of(event, grid),
              [&](std::size_t row, std::size_t column, int weight) { result[row][column] -= kTemplateUnit * weight; });
  }
  return result;
}

Tracker::Update PlainTracker::push(const Event& event) {
  if (!in_range(event.x - grid_.x, event.y - grid_.y)) return Tracker::Update::out_of_range;
  if (!running_) {
    window_.push_back(event);
    if (window_.size() < kWindowSize) return Tracker::Update::collecting;
    running_ = true;
    t_ = window_[kWindowSize / 2].t;
    for (int i = 0; i < kWindowSize; ++i) learn(window_[index(i)], event_weight(options_.variant, i));
    initialise_hypotheses();
    scale_scores();
    return Tracker::Update::started;
  }
  const Event oldest = window_.front();
  append(event);
  update_scores(oldest);
  const std::size_t h = best_hypothesis();
  if (h != 0) {
    grid_ = grid_ + kSteps[h];
    t_ = window_[kWindowSize / 2].t;
    initialise_hypotheses();
  }
  learn(window_[kWindowSize / 2], options_.template_learning * double{event_weight(options_.variant, kWindowSize / 2)});
  scale_scores();
  return h != 0 ? Tracker::Update::changed : Tracker::Update::regular;
}

void PlainTracker::append(const Event& event) {
  window_.pop_front();
  window_.push_back(event);
  if (options_.variant != Variant::haste_correlation) return;
  samples_.pop_front();
  samples_.emplace_back();
  for (std::size_t h = 0; h < kHypotheses; ++h) samples_.back()[h] = sample(event, grid_ + kSteps[h]);
}

void PlainTracker::initialise_hypotheses() {
  switch (options_.variant) {
    case Variant::correlation:
    case Variant::haste_correlation:
      samples_.clear();
      for (const Event& event : window_) {
        samples_.emplace_back();
        for (std::size_t h = 0; h < kHypotheses; ++h) samples_.back()[h] = sample(event, grid_ + kSteps[h]);
      }
      weigh_samples();
      break;
    case Variant::haste_correlation_star:
      quantised_ = quantised_template();
      for (std::size_t h = 0; h < kHypotheses; ++h) {
        raw_[h] = 0.0;
        for (const Event& event : window_) {
          for_cells(footprint_of(event, grid_ + kSteps[h]), [&](std::size_t row, std::size_t column, int weight) {
            raw_[h] += static_cast<double>(quantised_[row][column] * weight);
          });
        }
      }
      break;
    case Variant::haste_difference:
    case Variant::haste_difference_star:
      for (std::size_t h = 0; h < kHypotheses; ++h) {
        differences_[h] = difference(grid_ + kSteps[h], quantised_template());
        raw_[h] = 0.0;
        for (const auto& row : differences_[h]) {
          for (const std::int64_t cell : row) raw_[h] -= static_cast<double>(cell * cell);
        }
      }
      break;
  }
}

void PlainTracker::update_scores(const Event& oldest) {
  switch (options_.variant) {
    case Variant::correlation:
    case Variant::haste_difference: initialise_hypotheses(); break;
    case Variant::haste_correlation: weigh_samples(); break;
    case Variant::haste_correlation_star:
      for (std::size_t h = 0; h < kHypotheses; ++h) {
        for (const int sign : {1, -1}) {
          const Event& event = sign > 0 ? window_.back() : oldest;
          for_cells(footprint_of(event, grid_ + kSteps[h]), [&](std::size_t row, std::size_t column, int weight) {
            raw_[h] += static_cast<double>(sign * quantised_[row][column] * weight);
          });
        }
      }
      break;
    case Variant::haste_difference_star:
      for (std::size_t h = 0; h < kHypotheses; ++h) {
        add_to_difference(h, window_.back(), -1);
        add_to_difference(h, oldest, 1);
      }
      break;
  }
}

void PlainTracker::weigh_samples() {
  for (std::size_t h = 0; h < kHypotheses; ++h) {
    raw_[h] = 0.0;
    for (int i = 0; i < kWindowSize; ++i) {
      raw_[h] += double{event_weight(options_.variant, i)} * double{samples_[index(i)][h]};
    }
  }
}

void PlainTracker::add_to_difference(std::size_t h, const Event& event, int sign) {
  for_cells(footprint_of(event, grid_ + kSteps[h]), [&](std::size_t row, std::size_t column, int weight) {
    std::int64_t& cell = differences_[h][row][column];
    raw_[h] += static_cast<double>(cell * cell);
    cell += sign * kTemplateUnit * weight;
    raw_[h] -= static_cast<double>(cell * cell);
  });
}

std::size_t PlainTracker::best_hypothesis() const {
  std::size_t best = 0, worst = 0;
  for (std::size_t h = 1; h < kHypotheses; ++h) {
    if (raw_[h] > raw_[best]) best = h;
    if (raw_[h] < raw_[worst]) worst = h;
  }
  return raw_[best] - raw_[0] > options_.change_threshold * (raw_[best] - raw_[worst]) ? best : 0;
}

void PlainTracker::scale_scores() {
  constexpr double kWindow = double{kWindowSize} * kUnit * kTemplateUnit;
  double unit = 0.0;
  switch (options_.variant) {
    case Variant::correlation:
    case Variant::haste_correlation: unit = 1.0 / (double{kWindowSize} * kUnit * mass_); break;
    case Variant::haste_correlation_star: unit = 1.0 / (kWindow * kWindowSize * kUnit); break;
    case Variant::haste_difference:
    case Variant::haste_difference_star: unit = 1.0 / (kWindow * kWindow); break;
  }
  for (std::size_t h = 0; h < kHypotheses; ++h) scores_.of[h] = unit * raw_[h];
}

}  // namespace evbench::haste::testing
