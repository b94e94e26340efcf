#pragma once

#include <limits>
#include <span>
#include <vector>

#include "core/geometry/types.hpp"
#include "core/support/json.hpp"

namespace evbench::report {

constexpr double kMissing = std::numeric_limits<double>::quiet_NaN();
inline const Vector3 kNoVector = Vector3::Constant(kMissing);

/// A series of numbers as the page reads it (bench/report/page/src/data.ts, Column). NaN: missing.
/// Times [s]: equidistant ones as three numbers, others to half a millisecond.
Json times(std::span<const double> values);
/// Values in single precision: for a few that are far from the others.
Json single(std::span<const double> values);
/// Values as 16-bit integers between their least and largest: off by at most 1/65,000 of that range.
Json coarse(std::span<const double> values);

/// Three columns: x, y, z.
Json vectors(const std::vector<Vector3>& values, Json (*column_of)(std::span<const double>) = coarse);
/// Four columns: x, y, z, w.
Json orientations(const std::vector<Eigen::Quaterniond>& values);

/// Of the two quaternions of a rotation the one that is nearer to the last of `before`, so that lines do not jump.
Eigen::Quaterniond on_one_side(const std::vector<Eigen::Quaterniond>& before, const Eigen::Quaterniond& q);

/// The values at these indices.
std::vector<double> chosen(const std::vector<double>& values, const std::vector<std::size_t>& indices);

}  // namespace evbench::report
