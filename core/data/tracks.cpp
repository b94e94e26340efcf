#include "core/data/tracks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <tuple>

#include "core/geometry/camera.hpp"
#include "core/io/text_reader.hpp"
#include "core/support/error.hpp"

namespace evbench {
namespace {

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

TrackFile read_tracks(const std::string& path, int width, int height, double sigma) {
  TrackFile file;
  std::vector<TrackObservation>& all = file.observations;
  TextReader reader(path);
  while (reader.next()) {
    reader.expect_columns(4, "id t x y");
    all.push_back({reader.integer(0, "the id"),
                   reader.number(1, "the time"),
                   {reader.number(2, "x"), reader.number(3, "y")},
                   sigma});
  }
  if (all.empty()) throw InputError(fmt::format("{}: holds no observation; expected records id t x y", path));

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

std::string format_tracks(std::span<const TrackObservation> observations) {
  fmt::memory_buffer text;
  for (const TrackObservation& o : observations) {
    fmt::format_to(std::back_inserter(text), "{} {} {} {}\n", o.track, o.t, o.pixel.x(), o.pixel.y());
  }
  return fmt::to_string(text);
}

}  // namespace evbench
