#include <algorithm>
#include <cmath>
#include <optional>

#include "core/geometry/so3.hpp"
#include "core/support/index.hpp"
#include "eval/pose_error.hpp"

namespace evbench {
namespace {

using IndexPairs = std::vector<std::pair<std::size_t, std::size_t>>;

void check(const RelativeOptions& options) {
  const auto fail = [&](const char* expected) {
    throw InputError(fmt::format("the delta of the relative error is {} {}; expected {}", options.delta,
                                 kDeltaUnitNames[index(options.unit)], expected));
  };
  if (!(options.delta > 0.0) || !std::isfinite(options.delta)) fail("a number above 0");
  if (options.unit == DeltaUnit::frames && options.delta != std::floor(options.delta)) fail("a whole number");
  if (options.unit == DeltaUnit::degrees && options.delta > 180.0) fail("at most 180");
}

IndexPairs pairs_by_frames(std::size_t count, std::size_t delta, Pairing pairing) {
  IndexPairs result;
  const std::size_t step = pairing == Pairing::all ? 1 : delta;
  for (std::size_t i = 0; i < count && count - i > delta; i += step) result.emplace_back(i, i + delta);
  return result;
}

/// The index after `i` whose place is nearest to place[i] + delta, the first of equally near ones; none if that is
/// farther from delta than the tolerance. `place` does not decrease.
std::optional<std::size_t> nearest_after(const std::vector<double>& place, std::size_t i, double delta,
                                         double tolerance) {
  const auto begin = place.begin() + static_cast<std::ptrdiff_t>(i) + 1;
  if (begin == place.end()) return std::nullopt;
  const auto error = [&](auto position) { return std::abs(*position - place[i] - delta); };
  auto best = std::lower_bound(begin, place.end(), place[i] + delta);
  if (best != begin) {
    const auto before = std::lower_bound(begin, best, *(best - 1));
    if (best == place.end() || error(before) <= error(best)) best = before;
  }
  if (error(best) > tolerance) return std::nullopt;
  return static_cast<std::size_t>(best - place.begin());
}

IndexPairs pairs_by_place(const std::vector<double>& place, double delta, double tolerance, Pairing pairing) {
  IndexPairs result;
  for (std::size_t i = 0; i < place.size();) {
    const std::optional<std::size_t> j = nearest_after(place, i, delta, tolerance);
    if (j) result.emplace_back(i, *j);
    i = j && pairing == Pairing::consecutive ? *j : i + 1;
  }
  return result;
}

/// The indices at which the sum of steps (step i is from i to i + 1) reaches delta, restarting from zero each time.
std::vector<std::size_t> cuts(const std::vector<double>& steps, double delta) {
  std::vector<std::size_t> result;
  double sum = 0.0;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    sum += steps[i];
    if (sum >= delta) {
      result.push_back(i + 1);
      sum = 0.0;
    }
  }
  return result;
}

IndexPairs chain(const std::vector<std::size_t>& indices) {
  IndexPairs result;
  for (std::size_t k = 1; k < indices.size(); ++k) result.emplace_back(indices[k - 1], indices[k]);
  return result;
}

double angle_between(const SE3& a, const SE3& b) { return so3::log(a.q.conjugate() * b.q).norm() * kDegrees; }

IndexPairs pairs_by_metres(const std::vector<SE3>& poses, const RelativeOptions& options) {
  std::vector<double> steps, place = {0.0};
  for (std::size_t i = 1; i < poses.size(); ++i) {
    steps.push_back((poses[i].p - poses[i - 1].p).norm());
    place.push_back(place.back() + steps.back());
  }
  if (options.pairing == Pairing::consecutive) return chain(cuts(steps, options.delta));
  return pairs_by_place(place, options.delta, options.tolerance * options.delta, Pairing::all);
}

IndexPairs pairs_by_degrees(const std::vector<SE3>& poses, const RelativeOptions& options) {
  if (options.pairing == Pairing::consecutive) {
    std::vector<double> steps;
    for (std::size_t i = 1; i < poses.size(); ++i) steps.push_back(angle_between(poses[i - 1], poses[i]));
    std::vector<std::size_t> indices = cuts(steps, options.delta);
    indices.insert(indices.begin(), 0);
    return chain(indices);
  }
  IndexPairs result;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    for (std::size_t j = i + 1; j < poses.size(); ++j) {
      const double error = angle_between(poses[i], poses[j]) - options.delta;
      if (std::abs(error) <= options.tolerance * options.delta) result.emplace_back(i, j);
    }
  }
  return result;
}

}  // namespace

std::vector<std::pair<std::size_t, std::size_t>> delta_pairs(std::span<const PosePair> pairs,
                                                             const RelativeOptions& options) {
  check(options);
  if (pairs.empty()) return {};
  if (options.unit == DeltaUnit::frames) {
    const double delta =
        std::min(options.delta, static_cast<double>(pairs.size()));  // a larger delta has no pairs either
    return pairs_by_frames(pairs.size(), static_cast<std::size_t>(delta), options.pairing);
  }
  if (options.unit == DeltaUnit::seconds) {
    std::vector<double> times;
    for (const PosePair& pair : pairs) times.push_back(pair.t);
    return pairs_by_place(times, options.delta, options.tolerance * options.delta, options.pairing);
  }
  std::vector<SE3> poses;
  for (const PosePair& pair : pairs) {
    poses.push_back(options.source == PairSource::estimate ? pair.estimate : pair.ground_truth);
  }
  return options.unit == DeltaUnit::metres ? pairs_by_metres(poses, options) : pairs_by_degrees(poses, options);
}

}  // namespace evbench
