#include "core/process/json_lines.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/process/line_tail.hpp"
#include "core/support/index.hpp"
#include "core/support/json.hpp"
#include "core/support/json_reason.hpp"
#include "core/support/nearest.hpp"

namespace evbench::process {
namespace {

std::string shown(const Json& value) { return printable(printable_json(value), 100); }

[[noreturn]] void unexpected(const Json& found, const std::string& expected, const Place& place) {
  throw MessageError(fmt::format("{}: expected {}, found {}", place.text(), expected, shown(found)));
}

/// Reads [track, numbers...]. The first element of the result, in the track's place, is unused.
std::vector<double> track_row(const Json& value, const char* names, TrackId& track, const Place& place) {
  std::vector<double> row = numbers(value, names, place);
  track = integer(value[0], place);
  return row;
}

/// Calls read(item, place) for each item of a list and returns the results.
template <class Read>
auto each(const Json& value, const char* key, Read read) {
  std::vector<decltype(read(value, Place{key}))> result;
  result.reserve(list(value, {key}).size());
  for (std::size_t i = 0; i < value.size(); ++i) result.push_back(read(value[i], Place{key, i}));
  return result;
}

/// The names in the protocol; independent of the names shown to users.
template <class Value>
using Names = std::vector<std::pair<std::string, Value>>;

const Names<TrackingState> kTrackingStates = {
    {"no_map", TrackingState::no_map},         {"tracking", TrackingState::tracking},
    {"stationary", TrackingState::stationary}, {"standing_still", TrackingState::stationary},  // before version 1.0
    {"degraded", TrackingState::degraded},     {"lost", TrackingState::lost}};

template <class Value>
Value named(const Json& value, const Place& place, const Names<Value>& names) {
  const std::string name = text(value, place);
  std::vector<std::string> known;
  for (const auto& [candidate, meaning] : names) {
    if (candidate == name) return meaning;
    known.push_back(candidate);
  }
  throw MessageError(
      fmt::format("{}: unknown state \"{}\"{}", place.text(), printable(name, 60), suggestion(name, known)));
}

void check_order(double before, double t, const Place& place) {
  if (t < before) {
    throw MessageError(fmt::format("{}: time {} s is before that of the one before it, {} s; expected time order",
                                   place.text(), t, before));
  }
}

}  // namespace

std::string Place::text() const { return index ? fmt::format("{}[{}]", key, *index) : key; }

Json parse_object(const std::string& line) {
  Json value;
  try {
    value = parse_json(line);
  } catch (const nlohmann::json::exception& error) {
    const bool not_a_number = line.find("NaN") != std::string::npos || line.find("Infinity") != std::string::npos;
    throw MessageError(fmt::format("expected one JSON object a line, found {} ({})", printable(line, 200),
                                   not_a_number ? "JSON has no NaN and no Infinity" : json_reason(error)));
  }
  if (!value.is_object()) {
    throw MessageError(fmt::format("expected a JSON object, found {}", shown(value)));
  }
  return value;
}

void check_keys(const Json& object, const std::vector<std::string>& known) {
  for (const auto& [key, value] : object.items()) {
    if (std::ranges::find(known, key) != known.end()) continue;
    throw MessageError(fmt::format("unknown key \"{}\"{}", printable(key, 60), suggestion(key, known)));
  }
}

const Json* find(const Json& object, const char* key) {
  const auto found = object.find(key);
  return found == object.end() ? nullptr : &*found;
}

const Json& require(const Json& object, const char* key) {
  const Json* const value = find(object, key);
  if (value == nullptr) throw MessageError(fmt::format("\"{}\" is missing in {}", key, shown(object)));
  return *value;
}

double number(const Json& value, const Place& place) {
  const double result = value.is_number() ? value.get<double>() : std::nan("");
  if (!std::isfinite(result)) unexpected(value, "a finite number", place);
  return result;
}

std::int64_t integer(const Json& value, const Place& place) {
  if (value.is_number_float()) {  // some libraries write integers as 7.0
    const double result = value.get<double>();
    if (!(std::abs(result) <= 9007199254740992.0) || result != std::floor(result)) {
      unexpected(value, "an integer", place);
    }
    return static_cast<std::int64_t>(result);
  }
  const bool too_large = value.is_number_unsigned() &&
                         value.get<std::uint64_t>() > std::uint64_t{std::numeric_limits<std::int64_t>::max()};
  if (!value.is_number() || too_large) unexpected(value, "an integer of 64 bits with sign", place);
  return value.get<std::int64_t>();
}

std::string text(const Json& value, const Place& place) {
  if (!value.is_string()) unexpected(value, "a text", place);
  return value.get<std::string>();
}

const Json& list(const Json& value, const Place& place) {
  if (!value.is_array()) unexpected(value, "a list", place);
  return value;
}

std::vector<double> numbers(const Json& value, const char* names, const Place& place) {
  const std::string_view words = names;
  const auto count = static_cast<std::size_t>(std::ranges::count(words, ' ')) + 1;
  const bool fits = value.is_array() && value.size() == count &&
                    std::ranges::all_of(value, [](const Json& item) { return item.is_number(); });
  if (!fits) unexpected(value, fmt::format("{} numbers ({})", count, names), place);
  std::vector<double> result;
  result.reserve(count);
  for (const Json& item : value) result.push_back(number(item, place));
  return result;
}

StampedPose pose(const Json& value, const Place& place) {
  const std::vector<double> v = numbers(value, "t px py pz qx qy qz qw", place);
  const Eigen::Quaterniond q(v[7], v[4], v[5], v[6]);
  if (!(std::abs(q.norm() - 1.0) <= 1e-3)) {
    throw MessageError(fmt::format("{}: the quaternion's norm is {}; expected 1", place.text(), q.norm()));
  }
  return {v[0], {q.normalized(), {v[1], v[2], v[3]}}};
}

std::vector<StampedPose> poses(const Json& value, const char* key) {
  std::vector<StampedPose> result = each(value, key, pose);
  for (std::size_t i = 1; i < result.size(); ++i) {
    if (result[i - 1].t < result[i].t) continue;
    throw MessageError(
        fmt::format("{}[{}]: time {} s is not after that of the one before it, {} s; expected strictly "
                    "increasing times",
                    key, i, result[i].t, result[i - 1].t));
  }
  return result;
}

MovingPose moving_pose(const Json& value, const Place& place) {
  if (!value.is_array() || value.size() <= 8) return {pose(value, place), std::nullopt};
  const std::vector<double> v = numbers(value, "t px py pz qx qy qz qw wx wy wz vx vy vz", place);
  Json first = Json::array();
  for (std::size_t i = 0; i < 8; ++i) first.push_back(value[i]);
  return {pose(first, place), Vector6(v.data() + 8)};
}

TrackingState tracking_state(const Json& value) { return named(value, {"state"}, kTrackingStates); }

RunState run_state(const Json& value) {
  static const Names<RunState> names = {
      {"ok", RunState::ok}, {"degraded", RunState::degraded}, {"lost", RunState::lost}, {"failed", RunState::failed}};
  return named(value, {"status.state"}, names);
}

std::string name_of(TrackingState state) {
  return std::ranges::find(kTrackingStates, state, &Names<TrackingState>::value_type::second)->first;
}

Matrix12 covariance(const Json& value) {
  const Place place{"covariance"};
  if (!value.is_array() || value.size() != 144) unexpected(value, "144 numbers, row by row", place);
  Matrix12 result;
  for (Eigen::Index i = 0; i < 144; ++i) result(i / 12, i % 12) = number(value[index(i)], place);
  const double largest = result.cwiseAbs().maxCoeff();
  if ((result - result.transpose()).cwiseAbs().maxCoeff() > 1e-6 * largest || result.diagonal().minCoeff() < 0.0) {
    throw MessageError("covariance: expected a symmetric matrix without negative variances");
  }
  return 0.5 * (result + result.transpose());
}

std::vector<UndistortedFeature> expected_features(const Json& value) {
  return each(value, "expected", [](const Json& item, const Place& place) {
    UndistortedFeature feature;
    const std::vector<double> v = track_row(item, "track x y z u v Suu Suv Svv", feature.track, place);
    feature.position = {v[1], v[2], v[3]};
    feature.pixel = {v[4], v[5]};
    feature.covariance << v[6], v[7], v[7], v[8];
    if (v[6] < 0.0 || v[8] < 0.0) unexpected(item, "variances that are not negative", place);
    return feature;
  });
}

std::vector<TrackObservation> observations(const Json& value, const Json* covariances) {
  double before = -INFINITY;
  std::vector<TrackObservation> result = each(value, "observations", [&](const Json& item, const Place& place) {
    TrackObservation z;
    const std::vector<double> v = track_row(item, "track t x y sigma", z.track, place);
    z.t = v[1];
    z.pixel = {v[2], v[3]};
    z.noise = v[4];
    if (!z.noise.is_valid()) unexpected(item, "a sigma above 0", place);
    check_order(before, z.t, place);
    before = z.t;
    return z;
  });
  if (covariances == nullptr) return result;
  const std::vector<PixelNoise> noise = each(*covariances, "covariances", [](const Json& item, const Place& place) {
    const std::vector<double> v = numbers(item, "xx xy yy", place);
    const PixelNoise one(v[0], v[1], v[2]);
    if (!one.is_valid()) unexpected(item, "a positive definite covariance xx xy yy", place);
    return one;
  });
  if (noise.size() != result.size()) {
    throw MessageError(fmt::format("covariances: {} of them for {} observations; expected one for each, or none",
                                   noise.size(), result.size()));
  }
  for (std::size_t i = 0; i < result.size(); ++i) result[i].noise = noise[i];
  return result;
}

std::vector<TrackEnd> track_ends(const Json& value) {
  double before = -INFINITY;
  return each(value, "ended", [&](const Json& item, const Place& place) {
    TrackEnd end;
    end.t = track_row(item, "track t", end.track, place)[1];
    check_order(before, end.t, place);
    before = end.t;
    return end;
  });
}

std::vector<Landmark> landmarks(const Json& value) {
  return each(value, "map", [](const Json& item, const Place& place) {
    Landmark landmark;
    const std::vector<double> v = track_row(item, "track x y z", landmark.track, place);
    landmark.position = {v[1], v[2], v[3]};
    return landmark;
  });
}

std::vector<DegradedSpan> degraded_spans(const Json& value) {
  return each(value, "status.degraded", [](const Json& item, const Place& place) {
    if (!item.is_array() || item.size() != 3) unexpected(item, "[from, to, reason]", place);
    const DegradedSpan span{number(item[0], place), number(item[1], place), text(item[2], place)};
    if (span.to < span.from) unexpected(item, "a span that ends after it begins", place);
    return span;
  });
}

}  // namespace evbench::process
