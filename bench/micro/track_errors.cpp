// Errors of tracks of simulated events, against the ground truth:
//
//   track_errors RUN...
//
// of the folders of runs that kept their tracks (`evbench run CONFIG --tracks`, a source `event_simulation`). A track
// The error of a track is its distance from the image of the scene point of its first observation. Tracks that begin
// where there is no scene point, and observations of points that are hidden or outside the image, are left out. At an
// age, the next observation counts, for tracks that are old enough; alive are those that are still observed then. A
// track that is re-acquired after its end counts as another track, which begins there.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <map>
#include <string>
#include <vector>

#include "bench/experiment.hpp"
#include "core/data/tracks.hpp"
#include "core/plugin/exchange.hpp"
#include "core/plugin/registration.hpp"
#include "core/sources/event_simulation.hpp"
#include "core/support/error.hpp"
#include "core/support/median.hpp"

namespace {

using namespace evbench;

constexpr std::array kAges = {0.1, 0.5, 1.0};  // [s]
constexpr double kFar = 3.0;                   // [px]

struct Quality {
  std::array<std::vector<double>, kAges.size()> errors;          // [px]
  std::array<std::size_t, kAges.size()> alive = {}, could = {};  // could: began early enough to reach the age
  std::vector<double> lives;                                     // [s]
  std::size_t observations = 0, far = 0;
};

using Track = std::vector<const TrackObservation*>;  // from its beginning to an end

std::vector<Track> split(const std::vector<TrackObservation>& observations, std::vector<TrackEnd> ends) {
  std::ranges::stable_sort(ends, {}, &TrackEnd::t);
  std::vector<Track> tracks;
  std::map<TrackId, std::size_t> alive;
  in_time_order(
      observations, ends,
      [&](const TrackObservation& z) {
        const auto [track, is_new] = alive.try_emplace(z.track, tracks.size());
        if (is_new) tracks.emplace_back();
        tracks[track->second].push_back(&z);
      },
      [&](const TrackEnd& end) { alive.erase(end.track); });
  return tracks;
}

Quality measure(const SceneTruth& truth, const std::vector<Track>& tracks, double end) {
  Quality result;
  for (const Track& track : tracks) {
    const double begin = track.front()->t;
    const double life = track.back()->t - begin;
    const auto point = truth.point(track.front()->pixel, begin);
    result.lives.push_back(life);
    for (std::size_t i = 0; i < kAges.size(); ++i) {
      if (begin + kAges[i] > end) continue;
      ++result.could[i];
      result.alive[i] += life >= kAges[i] ? 1 : 0;
    }
    std::size_t age = 0;
    for (const TrackObservation* z : track) {
      const auto pixel = point ? truth.pixel(*point, z->t) : std::nullopt;
      if (!pixel) continue;
      const double error = (z->pixel - *pixel).norm();
      ++result.observations;
      result.far += error > kFar ? 1 : 0;
      for (; age < kAges.size() && z->t >= begin + kAges[age]; ++age) result.errors[age].push_back(error);
    }
  }
  return result;
}

void print(const std::string& name, const Quality& quality) {
  fmt::print("| {} |", name);
  for (std::size_t i = 0; i < kAges.size(); ++i) {
    const std::vector<double>& errors = quality.errors[i];
    if (errors.empty()) throw InputError(fmt::format("{}: no track is seen {} s after it began", name, kAges[i]));
    fmt::print(" {:.2f} / {:.2f} |", median(errors), order_statistic(errors, 0.9));
  }
  for (std::size_t i = 0; i < kAges.size(); ++i) {
    const double share = static_cast<double>(quality.alive[i]) / static_cast<double>(quality.could[i]);
    fmt::print("{} {:.2f}", i == 0 ? "" : " /", share);
  }
  fmt::print(" | {:.2f} / {:.2f} | {:.1f} | {} |\n", median(quality.lives), order_statistic(quality.lives, 0.9),
             100.0 * static_cast<double>(quality.far) / static_cast<double>(quality.observations),
             quality.observations);
}

}  // namespace

int main(int argc, char** argv) {
  std::vector<std::string> runs;
  CLI::App app{"How far off tracks of simulated events are, against the truth"};
  app.add_option("RUN", runs, "Folders of runs with tracks.txt")->required();
  CLI11_PARSE(app, argc, argv);
  try {
    Plugins plugins;
    add_registered_plugins(plugins, kBuiltIn);
    fmt::print(
        "| run | error at 0.1 s [px], median / 90 % | 0.5 s | 1 s | alive after 0.1 / 0.5 / 1 s | life [s], median / "
        "90 % | beyond {} px [%] | observations |\n| --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: |\n",
        kFar);
    for (const std::string& run : runs) {
      const auto source = read_source(run + "/config.json", plugins);
      const auto* const simulation = dynamic_cast<const EventSimulation*>(source.get());
      if (simulation == nullptr) {
        throw InputError(run + "/config.json: source: expected event_simulation, whose truth is known");
      }
      const Camera& camera = simulation->camera();
      const TrackFile tracks = read_tracks(run + "/tracks.txt", camera.width, camera.height);
      const std::vector<Track> lives = split(tracks.observations, read_track_ends(run + "/track_ends.txt"));
      print(run, measure(simulation->truth(), lives, simulation->time_range().to));
    }
  } catch (const std::exception& error) {
    fmt::print(stderr, "track_errors: {}\n", error.what());
    return 1;
  }
  return 0;
}
