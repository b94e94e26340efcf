#include "eval/segment_error.hpp"

#include <cmath>

namespace evbench {
namespace {

constexpr double kRpgTolerance = 0.2;     // relative to the length
constexpr double kRpgRounding = 100.0;    // lengths are whole centimetres
constexpr std::size_t kKittiStride = 10;  // poses; a second of KITTI's

using IndexPairs = std::vector<std::pair<std::size_t, std::size_t>>;

double in_metres(double length, const SegmentOptions& options, double path_m) {
  if (options.unit == LengthUnit::metres) return length;
  const double metres = length / 100.0 * path_m;
  return options.rule == SegmentRule::rpg ? std::trunc(kRpgRounding * metres) / kRpgRounding : metres;
}

IndexPairs rpg_segments(std::span<const PosePair> pairs, double length) {
  const IndexPairs segments = delta_pairs(pairs, {.delta = length,
                                                  .unit = DeltaUnit::metres,
                                                  .pairing = Pairing::all,
                                                  .tolerance = kRpgTolerance,
                                                  .source = PairSource::ground_truth});
  return segments.size() < 2 ? IndexPairs() : segments;
}

IndexPairs kitti_segments(std::span<const PosePair> pairs, double length) {
  std::vector<double> place = {0.0};
  for (std::size_t i = 1; i < pairs.size(); ++i) {
    place.push_back(place.back() + (pairs[i].ground_truth.p - pairs[i - 1].ground_truth.p).norm());
  }
  IndexPairs segments;
  for (std::size_t i = 0; i < pairs.size(); i += kKittiStride) {
    const auto last = std::ranges::upper_bound(place, place[i] + length);
    if (last == place.end()) break;
    segments.emplace_back(i, static_cast<std::size_t>(last - place.begin()));
  }
  return segments;
}

}  // namespace

SegmentOptions with_own_lengths(const SegmentOptions& options) {
  if (options.rule == SegmentRule::none || !options.lengths.empty()) return options;
  if (options.rule == SegmentRule::rpg) return {options.rule, {10, 20, 30, 40, 50}, LengthUnit::percent};
  return {options.rule, {100, 200, 300, 400, 500, 600, 700, 800}, LengthUnit::metres};
}

std::vector<SegmentErrors> segment_errors(std::span<const PosePair> pairs, const SegmentOptions& asked, double path_m) {
  if (asked.rule == SegmentRule::none) return {};
  const SegmentOptions options = with_own_lengths(asked);
  std::vector<SegmentErrors> result;
  for (const double length : options.lengths) {
    if (!(length > 0.0) || !std::isfinite(length)) {
      throw InputError(fmt::format("a segment's length is {}; expected a number above 0", length));
    }
    const double metres = in_metres(length, options, path_m);
    if (metres == 0.0) continue;
    PoseErrors errors = relative_errors(
        pairs, options.rule == SegmentRule::rpg ? rpg_segments(pairs, metres) : kitti_segments(pairs, metres));
    for (double& error : errors.trans_m) error *= 100.0 / metres;
    for (double& error : errors.rot_deg) error /= metres;
    result.push_back({metres, std::move(errors.trans_m), std::move(errors.rot_deg)});
  }
  return result;
}

}  // namespace evbench
