#pragma once

#include <optional>
#include <string>
#include <vector>

namespace evbench {

enum class Better { neither, lower, higher };

/// The tables in which a column stands where no columns are asked for.
struct ShownIn {
  bool print = false;    ///< LaTeX's, which must fit on a page
  bool screen = false;   ///< others with a row a run
  bool summary = false;  ///< others with several runs in a row
};

/// A number found in runs' metrics, and how it is shown.
struct Metric {
  std::string key;     ///< path into metrics.json or into its scores
  std::string header;  ///< for people
  Better better = Better::neither;
  ShownIn shown;
  std::optional<int> decimals = {};  ///< fixed; else as many as the smallest value of the column needs for three digits
  double factor = 1.0;               ///< shown is factor times the value
  std::string brief = {};            ///< a shorter header, for a column of a page; empty: the header
};

/// Those that have a header of their own, in the order of columns.
const std::vector<Metric>& known_metrics();

/// The metric of a key, known or not.
Metric metric_of(const std::string& key);

}  // namespace evbench
