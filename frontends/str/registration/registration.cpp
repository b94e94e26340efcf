#include "frontends/str/registration/registration.hpp"

#include <algorithm>

namespace evbench::str {
namespace {

std::span<const Event> between(std::span<const Event> events, std::int64_t from, std::int64_t to) {
  const auto first = std::ranges::lower_bound(events, from, {}, &Event::t);
  const auto last = std::ranges::lower_bound(first, events.end(), to, {}, &Event::t);
  return {first, last};
}

}  // namespace

std::string to_string(Registration::State state) {
  switch (state) {
    case Registration::State::good: return "good";
    case Registration::State::too_few_events: return "too few events";
    case Registration::State::not_converged: return "not converged";
    case Registration::State::poor: return "poor";
  }
  return "unknown";
}

Registrar::Registrar(const Camera& camera, const RegistrationOptions& options)
    : options_(options), rays_(camera), aligner_(options.alignment, rays_.focal_length()) {}

Registration Registrar::try_from(const Batch& batch, const Matrix3& start) {
  Registration result;
  const std::int64_t length = batch.to - batch.from;
  const std::int64_t slice = static_cast<std::int64_t>(options_.slice * static_cast<double>(length));
  const std::int64_t reference = batch.from + length / 2;
  result.reference = reference;
  const std::span<const Event> first = between(batch.events, batch.from, batch.from + slice);
  std::vector<Event> queries =
      take_evenly(first, options_.queries == 0 ? first.size() : static_cast<std::size_t>(options_.queries));
  sort_by_place(queries, rays_.width(), rays_.height());
  make_cloud(queries, rays_, reference, queries_);
  make_cloud(between(batch.events, batch.to - slice, batch.to), rays_, reference, targets_);
  const auto least = static_cast<std::size_t>(options_.least_events);
  if (queries_.size() < least || targets_.size() < least) return result;
  aligner_.swap_targets(targets_);
  const double duration = 1e-6 * static_cast<double>(length);
  result.alignment = aligner_.align(queries_, options_.model, start, duration, options_.alignment.gate);
  result.A = result.alignment.A;
  result.motion = aligner_.mean_motion(queries_, result.A, duration);
  result.chance = aligner_.chance_fit(queries_, result.A);
  if (!result.alignment.converged) {
    result.state = Registration::State::not_converged;
  } else if (result.beyond_chance(result.alignment.fit) < options_.least_fit) {
    result.state = Registration::State::poor;
  } else {
    result.state = Registration::State::good;
  }
  return result;
}

Registration Registrar::grow(const Batch& batch) {
  Registration result;
  std::optional<Matrix3> expected;
  for (int halvings = options_.halvings; halvings >= 0; --halvings) {
    const std::int64_t from = batch.to - ((batch.to - batch.from) >> halvings);
    const Batch part{between(batch.events, from, batch.to), from, batch.to};
    result = try_from(part, Matrix3::Zero());
    if (expected) {
      const Registration going_on = try_from(part, *expected);
      if (going_on.better_than(result)) result = going_on;
    }
    if (result.good() && result.motion >= options_.trusted_motion) expected = result.A;
  }
  result.grown = true;
  return result;
}

Registration Registrar::align(const Batch& batch, const std::optional<Matrix3>& expected) {
  if (!expected) return grow(batch);
  const Registration direct = try_from(batch, *expected);
  if (direct.good() || direct.state == Registration::State::too_few_events) return direct;
  const Registration grown = grow(batch);
  return grown.better_than(direct) ? grown : direct;
}

}  // namespace evbench::str
