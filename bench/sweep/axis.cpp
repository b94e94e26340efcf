#include "bench/sweep/axis.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <set>

#include "core/support/error.hpp"
#include "core/support/json.hpp"

namespace evbench {
namespace {

/// A larger number of values is a step that is too small by mistake.
constexpr int kMostValues = 100'000;

struct RangeOptions {
  double from = 0.0, to = 0.0, step = 0.0;
  int count = 0, digits = 6;
  enum class Scale { linear, logarithmic } scale = Scale::linear;

  void declare(OptionSet& set) {
    set.add("from", from, "first value").required();
    set.add("to", to, "last value, where the steps lead to it").required();
    set.add("step", step, "distance of two values; 1 where there is no count either").range(0.0);
    set.add("count", count, "number of values; 0: as the step says").range(0, kMostValues);
    set.add("scale", scale, {"linear", "logarithmic"}, "equal distances, or equal ratios (with a count)");
    set.add("digits", digits, "significant digits that values are rounded to").range(1, 15);
  }
};

struct AxisOptions {
  std::string name, key;
  Json values, range, overlays, zip;

  void declare(OptionSet& set) {
    set.add("name", name, "its name; by default its key");
    set.add("key", key, "path of what is varied in the config");
    set.add("values", values, "list of values");
    set.add("range", range, "values between two");
    set.add("overlays", overlays, "named sets of {KEY: VALUE}");
    set.add("zip", zip, "list of axes that advance together");
  }
};

AxisValue value_of(const std::string& key, const std::string& text) { return {text, {key + "=" + text}, {}}; }

std::string rounded(double value, int digits) {
  double result = 0.0;
  const std::string text = fmt::format("{:.{}g}", value, digits);
  std::from_chars(text.data(), text.data() + text.size(), result);
  return fmt::format("{}",
                     result == 0.0 ? 0.0 : result);  // the shortest text, without exponent where possible
}

std::vector<std::string> values_of(const RangeOptions& range, const std::string& place) {
  if (!(range.from <= range.to)) {
    throw InputError(fmt::format("{}: from {} to {}; expected the smaller value first", place, range.from, range.to));
  }
  if (range.step > 0.0 && range.count > 0) throw InputError(fmt::format("{}: expected a step or a count", place));
  if (range.count == 1) throw InputError(fmt::format("{}.count: 1 is no range; expected 2 or more", place));
  const bool logarithmic = range.scale == RangeOptions::Scale::logarithmic;
  if (logarithmic && (range.count == 0 || range.from <= 0.0)) {
    throw InputError(fmt::format("{}: expected a count, and values above 0, for a logarithmic scale", place));
  }
  const double step = range.step > 0.0 ? range.step : 1.0;
  const double steps = range.count > 0 ? range.count - 1 : std::floor((range.to - range.from) / step + 1e-9);
  if (!(steps < kMostValues)) throw InputError(fmt::format("{}: more than {} values", place, kMostValues));
  std::vector<std::string> values;
  for (int i = 0; i <= static_cast<int>(steps); ++i) {
    const double share = range.count > 0 ? i / steps : 0.0;
    const double value = range.count == 0 ? range.from + i * step
                         : logarithmic    ? range.from * std::pow(range.to / range.from, share)
                                          : range.from + share * (range.to - range.from);
    values.push_back(rounded(value, range.digits));
  }
  return values;
}

void check(const Axis& axis, const std::string& place) {
  if (axis.values.empty()) {
    throw InputError(fmt::format("{}: the axis \"{}\" has no values; expected one or more", place, axis.name));
  }
  std::set<std::string> seen;
  for (const AxisValue& value : axis.values) {
    if (seen.insert(value.text).second) continue;
    throw InputError(fmt::format("{}: the axis \"{}\" has the value {} twice", place, axis.name, value.text));
  }
}

std::vector<AxisValue> read_overlays(const Json& overlays, const std::string& place) {
  if (!overlays.is_object()) {
    throw InputError(fmt::format("{}: expected an object of named sets, each an object {{KEY: VALUE}}", place));
  }
  std::vector<AxisValue> values;
  for (const auto& [name, set] : overlays.items()) {
    if (!set.is_object()) throw InputError(fmt::format("{}.{}: expected an object {{KEY: VALUE}}", place, name));
    AxisValue value{name, {}, {}};
    for (const auto& [key, item] : set.items()) {
      if (key == "draw") {
        value.draw = item;
      } else {
        value.overrides.push_back(key + "=" + override_text(item));
      }
    }
    values.push_back(std::move(value));
  }
  return values;
}

ZippedAxes read_zip(const Json& zip, const std::string& place) {
  if (!zip.is_array() || zip.size() < 2)
    throw InputError(fmt::format("{}: expected a list of two axes or more", place));
  ZippedAxes axes;
  for (std::size_t i = 0; i < zip.size(); ++i) {
    for (Axis& axis : read_axis(zip[i], fmt::format("{}.{}", place, i))) axes.push_back(std::move(axis));
    const Axis &first = axes.front(), &last = axes.back();
    if (first.values.size() == last.values.size()) continue;
    throw InputError(fmt::format("{}: \"{}\" has {} values and \"{}\" {}; expected as many of each", place, first.name,
                                 first.values.size(), last.name, last.values.size()));
  }
  return axes;
}

/// Splits at commas that are outside of brackets and quotes.
std::vector<std::string> split(const std::string& text) {
  std::vector<std::string> parts(1);
  int depth = 0;
  bool quoted = false;
  for (const char c : text) {
    if (c == '"') quoted = !quoted;
    if (!quoted && (c == '[' || c == '{')) ++depth;
    if (!quoted && (c == ']' || c == '}')) --depth;
    if (c == ',' && depth == 0 && !quoted) {
      parts.emplace_back();
    } else {
      parts.back() += c;
    }
  }
  return parts;
}

std::optional<double> number(const std::string& text) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size() ? std::optional(value) : std::nullopt;
}

/// A..B, A..B:N or A..B:Nlog; nothing where the text has no two dots behind a number.
std::optional<RangeOptions> parse_range(const std::string& text, const std::string& place) {
  const std::size_t dots = text.find(".."), colon = text.find(':');
  if (dots == std::string::npos) return std::nullopt;
  const auto from = number(text.substr(0, dots));
  if (!from) return std::nullopt;
  const InputError none(
      fmt::format("{}: \"{}\" is no range; expected A..B, A..B:N or A..B:Nlog, N from 2 on", place, text));
  const auto to = number(text.substr(dots + 2, colon - dots - 2));
  if (!to || text[dots + 2] == '.') throw none;
  RangeOptions range;
  range.from = *from;
  range.to = *to;
  if (colon == std::string::npos) return range;
  std::string count = text.substr(colon + 1);
  if (count.ends_with("log")) {
    range.scale = RangeOptions::Scale::logarithmic;
    count.erase(count.size() - 3);
  }
  const auto values = number(count);
  if (!values || *values < 2.0 || *values > kMostValues || *values != std::floor(*values)) throw none;
  range.count = static_cast<int>(*values);
  return range;
}

}  // namespace

std::string override_text(const Json& value) { return value.is_string() ? value.get<std::string>() : dump_json(value); }

std::vector<std::string> AxisValue::keys() const {
  std::vector<std::string> result;
  for (const std::string& override : overrides) result.push_back(override.substr(0, override.find('=')));
  return result;
}

ZippedAxes read_axis(const Json& json, const std::string& place) {
  const auto options = read_options<AxisOptions>(json, place);
  const bool has_values = !options.values.is_null(), has_range = !options.range.is_null();
  const bool has_overlays = !options.overlays.is_null(), has_zip = !options.zip.is_null();
  if (has_values + has_range + has_overlays + has_zip != 1) {
    throw InputError(fmt::format("{}: expected one of \"values\", \"range\", \"overlays\", \"zip\"", place));
  }
  if (has_zip) {
    if (options.name.empty() && options.key.empty()) return read_zip(options.zip, place + ".zip");
    throw InputError(fmt::format("{}: zipped axes have names and keys of their own; expected \"zip\" alone", place));
  }
  if (has_overlays ? options.name.empty() || !options.key.empty() : options.key.empty()) {
    throw InputError(fmt::format("{}: expected {}", place,
                                 has_overlays ? "a \"name\" and no \"key\" beside \"overlays\""
                                              : "a \"key\": the path of what is varied in the config"));
  }
  Axis axis{options.name.empty() ? options.key : options.name, {}};
  if (has_overlays) axis.values = read_overlays(options.overlays, place + ".overlays");
  if (has_values) {
    if (!options.values.is_array()) throw InputError(fmt::format("{}.values: expected a list of values", place));
    for (const Json& value : options.values) axis.values.push_back(value_of(options.key, override_text(value)));
  }
  if (has_range) {
    const std::string at = place + ".range";
    for (const std::string& text : values_of(read_options<RangeOptions>(options.range, at), at)) {
      axis.values.push_back(value_of(options.key, text));
    }
  }
  check(axis, place);
  return {axis};
}

Axis parse_axis(const std::string& text) {
  const std::string place = "--vary " + text;
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos || equals == 0) throw InputError(fmt::format("{}: expected KEY=VALUES", place));
  Axis axis{text.substr(0, equals), {}};
  if (equals + 1 < text.size()) {
    for (const std::string& part : split(text.substr(equals + 1))) {
      if (part.empty()) throw InputError(fmt::format("{}: expected a value between two commas", place));
      if (const auto range = parse_range(part, place)) {
        for (const std::string& value : values_of(*range, place)) axis.values.push_back(value_of(axis.name, value));
      } else {
        axis.values.push_back(value_of(axis.name, part));
      }
    }
  }
  check(axis, place);
  return axis;
}

}  // namespace evbench
