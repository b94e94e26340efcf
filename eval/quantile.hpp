#pragma once

#include <span>
#include <vector>

namespace evbench {

/// The quantile p (0 to 1) of `sorted` (rising): linear between neighbours, as in numpy and R (type 7 of Hyndman and
/// Fan 1996). Values may be infinite: between a finite and an infinite value it is the infinite one, between −∞ and ∞
/// it is 0. NaN for no values.
double quantile(std::span<const double> sorted, double p);
/// The quantile of values in any order, none of which is NaN.
double quantile_of(std::vector<double> values, double p);

/// Median and quartiles of a value over repeated runs, in the values' unit.
struct Quartiles {
  double lower, median, upper;
};

/// The quartiles of values in any order, none of which is NaN.
Quartiles quartiles(std::vector<double> values);

}  // namespace evbench
