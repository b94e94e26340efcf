#include "bench/recordings/rate_plot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace evbench {

namespace {

constexpr double kSlow = 1e5;  // [events/s]; below it rates are not shown in millions

}  // namespace

std::string rate_text(double events_per_second) {
  if (events_per_second < 100.0) return fmt::format("{:.3g}/s", events_per_second);
  return events_per_second < kSlow ? fmt::format("{:.0f}/s", events_per_second)
                                   : fmt::format("{:.3f} million/s", events_per_second * 1e-6);
}

void RateHistogram::add(std::span<const Event> events) {
  for (const Event& event : events) {
    if (bins_.empty()) start_ = event.t;
    newest_ = event.t;
    auto bin = static_cast<std::size_t>((event.t - start_) / width_);
    while (bin >= kBins) {
      halve();
      bin = static_cast<std::size_t>((event.t - start_) / width_);
    }
    if (bin >= bins_.size()) bins_.resize(bin + 1);
    ++bins_[bin];
  }
}

/// Merges bins to half as many, twice as wide.
void RateHistogram::halve() {
  const std::size_t half = (bins_.size() + 1) / 2;
  for (std::size_t i = 0; i < half; ++i) {
    bins_[i] = bins_[2 * i] + (2 * i + 1 < bins_.size() ? bins_[2 * i + 1] : 0);
  }
  bins_.resize(half);
  width_ *= 2;
}

std::vector<double> RateHistogram::rates() const {
  std::vector<double> rates;
  for (std::size_t i = 0; i < bins_.size(); ++i) {
    const std::int64_t begin = start_ + static_cast<std::int64_t>(i) * width_;
    const std::int64_t end = std::min(begin + width_, newest_ + 1);
    rates.push_back(static_cast<double>(bins_[i]) / (static_cast<double>(end - begin) * 1e-6));
  }
  return rates;
}

std::vector<double> RateHistogram::resampled(std::size_t count) const {
  const std::vector<double> fine = rates();
  std::vector<double> result(count, 0.0);
  if (fine.empty()) return result;
  // In units of bins; the last one is as long as its events last.
  const double length = static_cast<double>(newest_ + 1 - start_) / static_cast<double>(width_);
  for (std::size_t i = 0; i < count; ++i) {
    const double from = length * static_cast<double>(i) / static_cast<double>(count);
    const double to = length * static_cast<double>(i + 1) / static_cast<double>(count);
    for (auto bin = static_cast<std::size_t>(from); bin < fine.size() && static_cast<double>(bin) < to; ++bin) {
      const double share = std::min(to, static_cast<double>(bin) + 1.0) - std::max(from, static_cast<double>(bin));
      result[i] += fine[bin] * share / (to - from);
    }
  }
  return result;
}

std::string plot_rates(const std::vector<double>& rates, double start, double end, int rows) {
  constexpr std::array<const char*, 9> kBars = {" ", "▁", "▂", "▃", "▄", "▅", "▆", "▇", "█"};
  const double most = rates.empty() ? 0.0 : *std::ranges::max_element(rates);
  const std::string top = most < kSlow ? fmt::format("{:.0f}", most) : fmt::format("{:.3f}", most * 1e-6);
  std::string text = most < kSlow ? "events/s\n" : "million events/s\n";
  for (int row = rows; row-- > 0;) {
    text += fmt::format("  {:>9} |", row == rows - 1 ? top : row == 0 ? "0" : "");
    for (const double rate : rates) {
      const double eighths = most > 0.0 ? std::ceil(8.0 * rows * rate / most) - 8.0 * row : 0.0;
      text += kBars[static_cast<std::size_t>(std::clamp(eighths, 0.0, 8.0))];
    }
    text += "\n";
  }
  const std::string from = fmt::format("{:.3f} s", start), to = fmt::format("{:.3f} s", end);
  const std::size_t gap = std::max<std::size_t>(rates.size(), from.size() + to.size() + 1) - from.size() - to.size();
  return text + fmt::format("  {:>9}  {}{}{}\n", "", from, std::string(gap, ' '), to);
}

}  // namespace evbench
