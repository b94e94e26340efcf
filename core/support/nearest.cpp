#include "core/support/nearest.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <limits>
#include <numeric>
#include <sstream>
#include <utility>
#include <vector>

namespace evbench {
namespace {

std::size_t edit_distance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t substitution = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({row[j] + 1, row[j - 1] + 1, substitution});
    }
  }
  return row.back();
}

/// The most similar candidates in a readable number: those that contain `name`, then those with the smallest edit
/// distance.
constexpr std::size_t kMostNames = 30, kSimilarNames = 6;

std::vector<std::string> most_similar(const std::string& name, std::span<const std::string> candidates) {
  std::vector<std::pair<std::size_t, std::string>> ranked;
  for (const std::string& candidate : candidates) {
    const bool contains = candidate.find(name) != std::string::npos;
    ranked.emplace_back(contains ? 0 : 1 + edit_distance(name, candidate), candidate);
  }
  std::ranges::stable_sort(ranked, {}, &std::pair<std::size_t, std::string>::first);
  std::vector<std::string> names;
  for (std::size_t i = 0; i < kSimilarNames; ++i) names.push_back(ranked[i].second);
  return names;
}

std::vector<std::string> parts_of(const std::string& path) {
  std::istringstream text(path);
  std::vector<std::string> parts;
  for (std::string part; std::getline(text, part, '.');) parts.push_back(part);
  return parts;
}

/// The shortest path (e.g. "ate.trans_m.rmse") that contains all parts of this one (e.g. "ate.rmse") in their order;
/// the first of equally long ones.
std::string fuller_path(const std::string& path, std::span<const std::string> candidates) {
  const std::vector<std::string> parts = parts_of(path);
  std::string best;
  if (parts.size() < 2) return best;
  std::size_t fewest = std::numeric_limits<std::size_t>::max();
  for (const std::string& candidate : candidates) {
    const std::vector<std::string> all = parts_of(candidate);
    auto wanted = parts.begin();
    for (const std::string& part : all) {
      if (wanted != parts.end() && part == *wanted) ++wanted;
    }
    if (wanted != parts.end() || all.size() >= fewest) continue;
    best = candidate;
    fewest = all.size();
  }
  return best;
}

}  // namespace

std::string nearest_name(const std::string& name, std::span<const std::string> candidates) {
  std::string best;
  std::size_t best_distance = std::max<std::size_t>(2, name.size() / 2) + 1;
  for (const std::string& candidate : candidates) {
    const std::size_t distance = edit_distance(name, candidate);
    if (distance < best_distance) {
      best = candidate;
      best_distance = distance;
    }
  }
  constexpr std::size_t kSlip = 2;  // typing errors
  if (!best.empty() && best_distance <= kSlip) return best;
  const std::string fuller = fuller_path(name, candidates);
  return fuller.empty() ? best : fuller;
}

std::string suggestion(const std::string& name, std::span<const std::string> candidates) {
  const std::string best = nearest_name(name, candidates);
  if (!best.empty()) return fmt::format("; did you mean \"{}\"?", best);
  if (candidates.empty()) return "; there are none";
  if (candidates.size() <= kMostNames) return fmt::format("; known: {}", fmt::join(candidates, ", "));
  return fmt::format("; the most similar of {}: {}", candidates.size(),
                     fmt::join(most_similar(name, candidates), ", "));
}

}  // namespace evbench
