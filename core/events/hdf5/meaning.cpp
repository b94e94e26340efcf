#include "core/events/hdf5/meaning.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/events/time_guess.hpp"
#include "core/support/error.hpp"
#include "core/support/index.hpp"

namespace evbench::hdf5 {
namespace {

struct Sample {
  std::vector<double> times;  ///< finite ones, sorted
  bool have_fractions = false;
  DarkerCount darker;

  double quantile(double share) const {
    return times.empty() ? 0.0
                         : times[index(static_cast<std::ptrdiff_t>(share * static_cast<double>(times.size() - 1)))];
  }
};

Sample take_sample(const EventTable& table) {
  constexpr std::uint64_t kRows = 1000;
  Sample sample;
  const std::uint64_t rows = table.rows(), count = std::min(rows, kRows);
  EventTable::Piece piece;
  for (const std::uint64_t begin : {std::uint64_t{0}, (rows - count) / 2, rows - count}) {
    table.read_times_and_polarities(begin, begin + count, piece);
    const ColumnViews views = table.views(piece, begin);
    sample.darker.add(views.p, count);
    for (std::size_t i = 0; i < count; ++i) {
      const double t = to_double(views.t, i);
      if (!std::isfinite(t)) continue;
      sample.times.push_back(t);
      sample.have_fractions |= t != std::floor(t);
    }
  }
  std::ranges::sort(sample.times);
  return sample;
}

/// In the unit of the times.
double read_offset(const File& file, const EventLayout& layout) {
  if (layout.offset.empty()) return 0.0;
  const Dataset dataset = file.dataset(layout.offset);
  return dataset.first(0);
}

/// Checks a guessed unit by the rate of all events but those of the earliest and latest tenth of the sample, so that
/// single broken times do not count. Microseconds that are taken for seconds make a million times fewer events a
/// second.
void check_rate(const EventTable& table, const Sample& sample, TimeUnit unit) {
  const double fewest = unit == TimeUnit::seconds ? 100.0 : 1.0;  // events a second
  const double duration = 1e6 / per_second(unit) * (sample.quantile(0.9) - sample.quantile(0.1));
  const auto count = static_cast<std::int64_t>(table.rows());
  const auto warning = implausible_rate(count, duration, unit);
  if (warning && static_cast<double>(count) < fewest * 1e-6 * duration) {
    throw InputError(
        fmt::format("{}: {}; --columns t_{},x,y,p (source.columns in a run's config) takes them as they are",
                    table.times().name(), *warning, kTimeUnitNames[index(unit)]));
  }
}

}  // namespace

Meaning find_meaning(const File& file, const EventLayout& layout, const EventTable& table, TimeUnit asked) {
  constexpr double kMostOffset = 2e18;  // [us]
  const Sample sample = take_sample(table);
  const double offset = read_offset(file, layout);
  Meaning meaning;
  meaning.darker = sample.darker.darker();
  meaning.scale.unit = asked;
  meaning.unit_origin = " (as asked for)";
  if (asked == TimeUnit::unsaid) {
    meaning.scale.unit = find_time_unit(file, layout);
    meaning.unit_origin = " (as an attribute says)";
  }
  if (meaning.scale.unit == TimeUnit::unsaid) {
    meaning.unit_is_guessed = true;
    meaning.scale.unit = guess_time_unit(sample.quantile(0.5) + offset, sample.have_fractions, table.times().name());
    meaning.unit_origin = sample.have_fractions ? " (as they have fractions)" : " (as they are whole numbers)";
  }
  const double offset_us = offset * 1e6 / per_second(meaning.scale.unit);
  if (!(std::abs(offset_us) < kMostOffset)) {
    throw InputError(fmt::format("{}: /{}: is no time", file.path(), layout.offset));
  }
  meaning.scale.offset = std::llround(offset_us);
  if (meaning.unit_is_guessed && table.rows() > 0) check_rate(table, sample, meaning.scale.unit);
  return meaning;
}

}  // namespace evbench::hdf5
