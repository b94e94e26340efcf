#pragma once

#include <optional>
#include <string>
#include <vector>

namespace evbench {

enum class Better { neither, lower, higher };

/// The tables that have a column by default.
struct ShownIn {
  bool print = false;    ///< LaTeX, which must fit on a page
  bool screen = false;   ///< other formats, a row per run
  bool summary = false;  ///< other formats, several runs in a row
};

/// A number in runs' metrics, and how tables show it.
struct Metric {
  std::string key;     ///< path into metrics.json or into its scores
  std::string header;  ///< for people
  Better better = Better::neither;
  ShownIn shown;
  std::optional<int> decimals = {};  ///< none: as many as the smallest value of the column needs for three digits
  double factor = 1.0;               ///< tables show factor times the value
  std::string brief = {};            ///< a shorter header, for a column of a page; empty: the header
};

/// The metrics with a header of their own, in the order of columns.
const std::vector<Metric>& known_metrics();

/// The metric of a key; the key is the header of an unknown one.
Metric metric_of(const std::string& key);

}  // namespace evbench
