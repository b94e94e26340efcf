#include "bench/report/track_lives.hpp"

#include <algorithm>
#include <filesystem>
#include <map>

#include "bench/report/column.hpp"
#include "core/data/tracks.hpp"
#include "core/io/file_content.hpp"

namespace evbench::report {
namespace {

/// What lies between a track's beginning, or its re-acquisition, and its end.
struct Piece {
  std::size_t row;
  double from, to;
  bool reacquired;
};

}  // namespace

Json tracks_json(const RunRecord& run, const Budget& budget) {
  const std::string path = run.folder + "/tracks.txt";
  if (!is_file(path) || std::filesystem::file_size(path) == 0) return nullptr;
  std::map<TrackId, std::vector<double>> ends;
  if (const std::string file = run.folder + "/track_ends.txt"; is_file(file)) {
    for (const TrackEnd& end : read_track_ends(file)) ends[end.track].push_back(end.t);
  }
  const TrackFile file = read_tracks(path, kAnySize, kAnySize);
  std::map<TrackId, std::pair<std::size_t, std::size_t>> last;  // row, its newest piece
  std::vector<Piece> pieces;
  for (const TrackObservation& z : file.observations) {
    const auto [entry, is_new] = last.try_emplace(z.track, last.size(), pieces.size());
    const auto has_ended = [&](double since) {
      const auto& all = ends[z.track];
      return std::ranges::any_of(all, [&](double t) { return t >= since && t < z.t; });
    };
    if (is_new || has_ended(pieces[entry->second.second].to)) {
      entry->second.second = pieces.size();
      pieces.push_back({entry->second.first, z.t, z.t, !is_new});
    } else {
      pieces[entry->second.second].to = z.t;
    }
  }
  const std::size_t tracks = last.size();
  const std::size_t every = (tracks + budget.tracks() - 1) / budget.tracks();
  std::vector<double> row, from, to, reacquired;
  for (const Piece& piece : pieces) {
    if (piece.row % every != 0) continue;
    row.push_back(static_cast<double>(piece.row));
    from.push_back(piece.from);
    to.push_back(piece.to);
    reacquired.push_back(piece.reacquired ? 1.0 : 0.0);
  }
  std::vector<double> live_t, live;
  const double begin = file.observations.front().t, end = file.observations.back().t;
  const std::size_t samples = budget.updates();
  std::vector<double> begins, finishes;
  for (const Piece& piece : pieces) {
    begins.push_back(piece.from);
    finishes.push_back(piece.to);
  }
  std::ranges::sort(begins);
  std::ranges::sort(finishes);
  for (std::size_t i = 0; i <= samples; ++i) {
    const double t = begin + (end - begin) * static_cast<double>(i) / static_cast<double>(samples);
    live_t.push_back(t);
    live.push_back(static_cast<double>(std::ranges::upper_bound(begins, t) - begins.begin()) -
                   static_cast<double>(std::ranges::lower_bound(finishes, t) - finishes.begin()));
  }
  return {{"total", tracks},
          {"row", coarse(row)},
          {"from", times(from)},
          {"to", times(to)},
          {"reacquired", coarse(reacquired)},
          {"live_t", times(live_t)},
          {"live", coarse(live)}};
}

}  // namespace evbench::report
