#include "frontends/recorded/recorded.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <utility>

#include "core/data/tracks.hpp"
#include "core/io/path.hpp"
#include "core/plugin/registration.hpp"
#include "core/support/error.hpp"

namespace evbench {
namespace {

const Registration<FrontEnd, Recorded> registration("recorded",
                                                    "tracks from a file (id t x y, HASTE's, or named columns)");

}  // namespace

void Recorded::Options::declare(OptionSet& set) {
  set.add("tracks", tracks, "path of the track file").required().path();
  set.add("ends", ends,
          "path of a file with the ends of tracks (id t [s]), which may continue later; empty: at their last "
          "observations")
      .path();
  set.add("columns", columns,
          "order of the file's columns, e.g. \"t x y - id\", - for one that is not read; empty: from a line of names, "
          "id t x y, or HASTE's t x y theta id");
  set.add("time_unit", time_unit, {kTimeUnitNames.begin(), kTimeUnitNames.end()},
          "unit of the file's times; auto: from the column's name (t_us), or seconds, from 1e17 on nanoseconds");
  set.add("sigma", sigma, "standard deviation of an observation [px]").range(1e-6, 1e6);
  set.add("outside", outside, "what to do with observations outside the image").choices({"keep", "drop"});
  set.add("min_track_length", min_track_length, "tracks with fewer observations are left out").range(1);
}

Recorded::Recorded(const Options& options, const FrontEndContext& context)
    : path_(resolve_path(options.tracks, context.folder)) {
  const Camera& camera = context.source.camera();
  TrackFile file = read_tracks(path_, camera.width, camera.height, {options.sigma, options.columns, options.time_unit});
  const TrackFileReport& report = file.report;
  remarks_.push_back(fmt::format("{}: {} observations of {} tracks", path_, report.records, report.tracks));
  if (!file.assumption.empty()) remarks_.push_back(file.assumption);
  const auto remark = [&](std::int64_t count, const char* what) {
    if (count > 0) remarks_.push_back(fmt::format("{}: {} {}", path_, count, what));
  };
  const bool drop_outside = options.outside == "drop";
  remark(report.unordered, "observations out of order in their track (sorted)");
  remark(report.duplicates, "observations with the track and time of another (dropped)");
  remark(report.outside,
         drop_outside ? "observations outside the image (dropped)" : "observations outside the image (kept)");
  remark(report.single_observation, "tracks with a single observation");

  observations_ = std::move(file.observations);
  const TimeRange range = context.source.time_range();
  const double first = observations_.front().t, last = observations_.back().t;
  if (first > range.to || last < range.from) {
    throw InputError(fmt::format("{}: no observation is left between {} and {} s, the source's time range: times {}",
                                 path_, range.from, range.to,
                                 times_outside(first, last, range.from, range.to, "time_unit")));
  }
  const auto beyond = [&](const TrackObservation& o) { return o.t < range.from || o.t > range.to; };
  remark(static_cast<std::int64_t>(std::erase_if(observations_, beyond)),
         fmt::format("observations outside {} to {} s (left out)", range.from, range.to).c_str());
  if (drop_outside) {
    std::erase_if(observations_, [&](const TrackObservation& o) { return !camera.contains(o.pixel); });
  }
  drop_short_tracks(options.min_track_length);
  if (observations_.empty()) {
    throw InputError(fmt::format(
        "{}: no observation is left between {} and {} s, inside the image, in tracks of {} or more of them; "
        "expected some",
        path_, range.from, range.to, options.min_track_length));
  }
  std::vector<TrackEnd> ends;
  if (!options.ends.empty()) ends = read_track_ends(resolve_path(options.ends, context.folder));
  for (TrackEnd& end : ends) end.t = std::min(end.t, range.to);
  player_ = TrackPlayer(observations_, std::move(ends));
}

void Recorded::drop_short_tracks(int min_length) {
  std::map<TrackId, int> lengths;
  for (const TrackObservation& o : observations_) ++lengths[o.track];
  const auto tracks = std::ranges::count_if(lengths, [&](const auto& track) { return track.second < min_length; });
  if (tracks == 0) return;
  std::erase_if(observations_, [&](const TrackObservation& o) { return lengths[o.track] < min_length; });
  remarks_.push_back(
      fmt::format("{}: {} tracks with fewer than {} observations (left out)", path_, tracks, min_length));
}

}  // namespace evbench
