#pragma once

#include <optional>

#include "backends/gp_map/estimate.hpp"
#include "backends/gp_map/modules/alternative_estimate.hpp"
#include "core/plugin/options.hpp"

namespace evbench::gp_map {

struct SearchOptions {
  bool enabled = true;
  double interval = 0.15;
  double first = 0.7;

  void declare(OptionSet& set);
};

/// Searches a better alternative estimate of the recent part, or of a whole tentative map where no recent part can be
/// searched. It begins with one of two planes, in turn. One search at a time, each in shares of bounded work.
class HypothesisSearch {
 public:
  /// `begin`: time of the first state [s].
  HypothesisSearch(const SearchOptions& options, double begin)
      : options_(options), next_(begin + options.first), checks_left_(options.enabled ? kPlanes : 0) {}

  /// Does a share of the work. A better estimate, if one was found now.
  std::optional<AlternativeEstimate> advance(Estimate& estimate);

  bool in_progress() const { return search_.has_value(); }
  /// Has the search failed on each plane, since the last alternative was found?
  bool is_exhausted() const { return checks_left_ == 0; }

 private:
  static constexpr int kPlanes = 2;

  std::optional<AlternativeSearch> begin(const Estimate& estimate, StructureHypothesis hypothesis,
                                         bool everything) const;

  SearchOptions options_;
  double next_;       ///< [s] of the next search
  int searches_ = 0;  ///< number of those that were begun
  int checks_left_;   ///< failed searches that are missing for a confirmation
  std::optional<AlternativeSearch> search_;
};

}  // namespace evbench::gp_map
