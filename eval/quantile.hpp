#pragma once

#include <span>
#include <vector>

namespace evbench {

/// The value below which the share p (0 to 1) of `sorted` (rising) lies: linear between neighbours, as numpy and R have
/// it (type 7 of Hyndman and Fan 1996). Infinite values are values: between a finite and an infinite one lies the
/// infinite one, between −∞ and ∞ lies 0. NaN of none.
double quantile(std::span<const double> sorted, double p);
/// Of values in any order, none of which is NaN.
double quantile_of(std::vector<double> values, double p);

/// What is reported of a value over repeated runs, in the values' unit.
struct Quartiles {
  double lower, median, upper;
};

/// Of values in any order, none of which is NaN.
Quartiles quartiles(std::vector<double> values);

}  // namespace evbench
