#include "bench/report/column.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>

namespace evbench::report {
namespace {

std::string base64(const std::string& bytes) {
  constexpr const char* kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t triple = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      triple = triple << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0U);
    }
    for (std::size_t k = 0; k < 4; ++k) {
      text.push_back(i + k <= bytes.size() ? kDigits[triple >> (18 - 6 * k) & 63U] : '=');
    }
  }
  return text;
}

}  // namespace

Json single(std::span<const double> values) {
  std::string bytes;
  bytes.reserve(4 * values.size());
  for (const double value : values) {
    const auto bits = std::bit_cast<std::uint32_t>(static_cast<float>(value));
    for (unsigned shift = 0; shift < 32; shift += 8) bytes.push_back(static_cast<char>(bits >> shift & 0xffU));
  }
  return {{"f32", base64(bytes)}};
}

Json times(std::span<const double> values) {
  if (values.size() > 2) {
    const double step = (values.back() - values.front()) / static_cast<double>(values.size() - 1);
    bool even = true;
    for (std::size_t i = 0; i < values.size() && even; ++i) {
      even = std::abs(values[i] - values.front() - step * static_cast<double>(i)) < 1e-6;
    }
    if (even) return {{"from", values.front()}, {"step", step}, {"n", values.size()}};
  }
  constexpr double kExact = 1e4;  // [s]: in single precision to half a millisecond
  if (std::ranges::all_of(values, [](double value) { return std::abs(value) < kExact; })) return single(values);
  Json list = Json::array();
  for (const double value : values) list.push_back(std::round(1e6 * value) / 1e6);
  return list;
}

Json coarse(std::span<const double> values) {
  constexpr double kMost = 32767.0;
  constexpr std::int16_t kNone = std::numeric_limits<std::int16_t>::min();
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const double value : values) {
    if (!std::isfinite(value)) continue;
    low = std::min(low, value);
    high = std::max(high, value);
  }
  const bool any = low <= high;
  const double offset = any ? 0.5 * (low + high) : 0.0;
  const double scale = any && high > low ? 0.5 * (high - low) / kMost : 1.0;
  std::string bytes;
  bytes.reserve(2 * values.size());
  for (const double value : values) {
    const std::int16_t k =
        std::isfinite(value) ? static_cast<std::int16_t>(std::lround((value - offset) / scale)) : kNone;
    const auto bits = std::bit_cast<std::uint16_t>(k);
    bytes.push_back(static_cast<char>(bits & 0xffU));
    bytes.push_back(static_cast<char>(bits >> 8U));
  }
  return {{"i16", base64(bytes)}, {"scale", scale}, {"offset", offset}};
}

Json vectors(const std::vector<Vector3>& values, Json (*column_of)(std::span<const double>)) {
  Json columns = Json::array();
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> column;
    for (const Vector3& value : values) column.push_back(value[axis]);
    columns.push_back(column_of(column));
  }
  return columns;
}

Json orientations(const std::vector<Eigen::Quaterniond>& values) {
  Json columns = Json::array();
  for (int k = 0; k < 4; ++k) {
    std::vector<double> column;
    for (const Eigen::Quaterniond& value : values) column.push_back(value.coeffs()[k]);
    columns.push_back(coarse(column));
  }
  return columns;
}

Eigen::Quaterniond on_one_side(const std::vector<Eigen::Quaterniond>& before, const Eigen::Quaterniond& q) {
  return before.empty() || !(before.back().dot(q) < 0.0) ? q : Eigen::Quaterniond(-q.coeffs());
}

std::vector<double> chosen(const std::vector<double>& values, const std::vector<std::size_t>& indices) {
  std::vector<double> result;
  for (const std::size_t i : indices) result.push_back(values[i]);
  return result;
}

}  // namespace evbench::report
