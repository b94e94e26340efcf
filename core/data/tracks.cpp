#include "core/data/tracks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <tuple>

#include "core/data/columns.hpp"
#include "core/geometry/camera.hpp"
#include "core/io/text_reader.hpp"
#include "core/support/error.hpp"

namespace evbench {
namespace {

constexpr std::array kQuantities{Quantity{"id", "(.*_)?(id|trackid|featureid)|track|feature"}, kTime,
                                 Quantity{"x", "(.*_)?x|x_.*|u|px"}, Quantity{"y", "(.*_)?y|y_.*|v|py"}};
constexpr const char *kUsual = "id t x y", *kHaste = "t x y - id";

bool complete(const Columns& columns) { return !columns.find_all(kQuantities).empty(); }

bool is_integer(std::string_view text) {
  return text.find_first_not_of("0123456789", text.starts_with('-') ? 1 : 0) == std::string_view::npos;
}

/// The columns, determined at the first record; skips a line of names.
Columns find_columns(TextReader& reader, const std::string& asked) {
  if (!asked.empty()) {
    pass_over_names(reader);
    Columns columns(asked, kQuantities);
    if (complete(columns) && columns.ambiguity().empty()) return columns;
    throw InputError(fmt::format("{}: the requested columns are \"{:.80}\"; expected id, t, x and y, and - for others",
                                 reader.path(), asked));
  }
  if (const auto named = read_names(reader, kQuantities, complete, kUsual)) return *named;
  const auto record = reader.columns();
  const bool haste = record.size() == 5 && is_integer(record.back()) && !is_integer(record.front());
  const Columns columns(haste ? kHaste : kUsual, kQuantities);
  return haste ? columns : columns.followed_to(record.size());
}

std::string assumption(const std::string& path, const Columns& columns, TimeUnit unit) {
  if (columns.text() == kUsual && unit == TimeUnit::seconds) return "";
  return fmt::format("{}: read with columns {}, times in {}", path, columns.text(), to_string(unit));
}

std::int64_t count_unordered(std::span<const TrackObservation> in_file_order) {
  std::int64_t count = 0;
  std::map<TrackId, double> latest;
  for (const TrackObservation& o : in_file_order) {
    const auto [entry, is_new] = latest.try_emplace(o.track, o.t);
    if (o.t < entry->second) ++count;
    entry->second = std::max(entry->second, o.t);
  }
  return count;
}

void count_tracks(std::span<const TrackObservation> observations, TrackFileReport& report) {
  std::map<TrackId, std::int64_t> lengths;
  for (const TrackObservation& o : observations) ++lengths[o.track];
  report.tracks = static_cast<std::int64_t>(lengths.size());
  report.single_observation = std::ranges::count_if(lengths, [](const auto& track) { return track.second == 1; });
}

}  // namespace

TrackFile read_tracks(const std::string& path, int width, int height, const TrackFileOptions& options) {
  TrackFile file;
  std::vector<TrackObservation>& all = file.observations;
  TextReader reader(path);
  const auto expect_some = [&](bool some) {
    if (!some) throw InputError(fmt::format("{}: holds no observation; expected records {}", path, kUsual));
  };
  expect_some(reader.next());
  const Columns columns = find_columns(reader, options.columns);
  const std::vector<std::size_t> at = columns.find_all(kQuantities);
  std::optional<TimeColumn> time;
  for (; !reader.columns().empty(); reader.next()) {
    reader.expect_columns(columns.size(), columns.text().c_str());
    if (!time) {
      time.emplace(reader, columns, options.time_unit);
      time->expect_unit(reader);
      file.assumption = assumption(path, columns, time->unit());
    }
    all.push_back({reader.integer(at[0], "the id"),
                   time->read(reader),
                   {reader.number(at[2], "x"), reader.number(at[3], "y")},
                   options.sigma});
  }
  expect_some(!all.empty());

  file.report.records = static_cast<std::int64_t>(all.size());
  file.report.unordered = count_unordered(all);
  std::ranges::stable_sort(all, {}, [](const TrackObservation& o) { return std::tuple(o.t, o.track); });
  const auto repeated = std::unique(all.begin(), all.end(), [](const TrackObservation& a, const TrackObservation& b) {
    return a.t == b.t && a.track == b.track;
  });
  file.report.duplicates = all.end() - repeated;
  all.erase(repeated, all.end());

  Camera sensor;
  sensor.width = width;
  sensor.height = height;
  file.report.outside =
      std::ranges::count_if(all, [&](const TrackObservation& o) { return !sensor.contains(o.pixel); });
  count_tracks(all, file.report);
  return file;
}

std::vector<TrackEnd> read_track_ends(const std::string& path) {
  std::vector<TrackEnd> ends;
  for (TextReader reader(path); reader.next();) {
    reader.expect_columns(2, "id t");
    ends.push_back({reader.integer(0, "the id"), reader.number(1, "the time")});
  }
  return ends;
}

std::string format_tracks(std::span<const TrackObservation> observations) {
  fmt::memory_buffer text;
  for (const TrackObservation& o : observations) {
    fmt::format_to(std::back_inserter(text), "{} {} {} {}\n", o.track, o.t, o.pixel.x(), o.pixel.y());
  }
  return fmt::to_string(text);
}

std::string format_track_ends(std::span<const TrackEnd> ends) {
  fmt::memory_buffer text;
  for (const TrackEnd& end : ends) fmt::format_to(std::back_inserter(text), "{} {}\n", end.track, end.t);
  return fmt::to_string(text);
}

}  // namespace evbench
