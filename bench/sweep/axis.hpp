#pragma once

#include <string>
#include <vector>

#include "core/plugin/options.hpp"
#include "core/support/json.hpp"

namespace evbench {

/// The text of a value in an override "KEY=VALUE", as on a command line: text as it is, other values as JSON.
std::string override_text(const Json& value);

/// A value of an axis: its name, the overrides "KEY=VALUE" that it makes in a config, and what is drawn at random for
/// it (draw.hpp; null: nothing).
struct AxisValue {
  std::string text;
  std::vector<std::string> overrides;
  Json draw = {};

  /// The paths in the config that it sets.
  std::vector<std::string> keys() const;
};

/// A setting that is varied, and its values: at least one, no two with the same text.
struct Axis {
  std::string name;
  std::vector<AxisValue> values;
};

/// Axes that advance together, each with the same number of values.
using ZippedAxes = std::vector<Axis>;

/// One item of the list "axes" of a sweep's file:
///
///   {"key": KEY, "values": [VALUE, ...]}
///   {"key": KEY, "range": {"from": A, "to": B, "step": S | "count": N, "scale": "linear" | "logarithmic", "digits":
///   D}}
///   {"name": NAME, "overlays": {TEXT: {KEY: VALUE, ...}, ...}}
///   {"zip": [AXIS, ...]}
///
/// In an overlay the KEY "draw" has what is drawn at random for it (draw.hpp).
///
/// KEY is a path in the config, as for --set. A "name" takes the place of the key in tables. Values of a range are
/// rounded to D significant digits (6), whole numbers or not. `place` begins messages. Throws
/// InputError for an unknown key, an axis without values or with a value twice, and zipped axes of different lengths.
ZippedAxes read_axis(const Json& axis, const std::string& place);

/// An axis from a command line: KEY=VALUES, with values between commas that are outside of brackets and quotes. A..B
/// means whole numbers in steps of one, A..B:N means N values at equal distances, A..B:Nlog means N values at equal
/// ratios. Throws InputError likewise.
Axis parse_axis(const std::string& text);

}  // namespace evbench
