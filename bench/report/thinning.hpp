#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace evbench::report {

/// Numbers of samples that a report keeps of each series of a run, so that a report of 100 runs stays below 5 MB.
struct Budget {
  explicit Budget(std::size_t runs)
      : factor_(std::clamp(85.0 / static_cast<double>(std::max<std::size_t>(runs, 1)), 0.25, 20.0)) {}

  std::size_t trajectory() const { return of(250); }  ///< estimate and ground truth
  std::size_t causal() const { return of(150); }
  std::size_t covariances() const { return of(40); }
  std::size_t updates() const { return of(150); }
  std::size_t parameters() const { return of(80); }
  std::size_t landmarks() const { return of(100); }
  std::size_t tracks() const { return of(100); }
  std::size_t log_characters() const { return of(1500); }
  bool shows_details() const { return factor_ >= 5.0; }  ///< configs, causal estimates

 private:
  std::size_t of(double samples) const { return static_cast<std::size_t>(samples * factor_); }
  double factor_;
};

/// The indices of at most `most` (≥ 2) of `count` items, evenly spaced, with the first and the last.
inline std::vector<std::size_t> thinned(std::size_t count, std::size_t most) {
  std::vector<std::size_t> indices;
  const std::size_t kept = std::min(count, most);
  for (std::size_t i = 0; i < kept; ++i) indices.push_back(kept == count ? i : i * (count - 1) / (kept - 1));
  return indices;
}

}  // namespace evbench::report
