#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <string>
#include <vector>

#include "bench/commands/commands.hpp"
#include "bench/commands/name_check.hpp"
#include "bench/commands/run_outputs.hpp"
#include "core/data/tracks.hpp"
#include "core/support/error.hpp"
#include "eval/table_text.hpp"
#include "eval/track_benchmark.hpp"

namespace evbench {
namespace {

inline constexpr NameList<3> kTrackProtocols = {"full", "cropped", "both"};

struct EvalTracksArguments {
  std::string truth;
  std::vector<std::string> tracks;
  std::string protocol = "both", format = "text";
  TextOutput out;
};

std::vector<TrackObservation> read(const std::string& path) {
  TrackFile file = read_tracks(path, kAnySize, kAnySize);
  if (!file.assumption.empty()) fmt::print(stderr, "evbench eval-tracks: {}\n", file.assumption);
  return std::move(file.observations);
}

void add_rows(TextTable& table, const std::string& path, const std::string& protocol,
              const std::vector<TrackObservation>& truth, const std::vector<TrackObservation>& tracks, bool csv) {
  for (const auto& [name, value] : {std::pair{"full", TrackProtocol::full}, {"cropped", TrackProtocol::cropped}}) {
    if (protocol != "both" && protocol != name) continue;
    const TrackBenchmark b = [&, value = value] {
      try {
        return benchmark_tracks(truth, tracks, value);
      } catch (const InputError& error) {
        throw InputError(fmt::format("{}: {}", path, error.what()));
      }
    }();
    const auto number = [&](double x) {
      return TextTable::Cell{csv ? fmt::format("{}", x) : fmt::format("{:.3f}", x)};
    };
    table.rows.push_back({{path},
                          {name},
                          {fmt::format("{}", b.tracks)},
                          number(b.expected_age),
                          number(b.inlier_ratio),
                          number(b.age),
                          number(b.age_5px),
                          number(b.error_5px)});
  }
}

void execute(const EvalTracksArguments& arguments) {
  arguments.out.check();
  const auto format = parse_name<TableFormat>(kTableFormatNames, arguments.format, "table format");
  if (format == TableFormat::long_csv) {
    throw InputError("--format long is of runs; expected text, markdown, csv or latex");
  }
  const bool csv = format == TableFormat::csv;
  const std::vector<TrackObservation> truth = read(arguments.truth);
  TextTable table;
  table.columns = {{csv ? "tracks_file" : "", false},
                   {"protocol", false},
                   {"tracks"},
                   {csv ? "expected_age" : "expected age"},
                   {csv ? "inlier_ratio" : "inlier ratio"},
                   {"age"},
                   {csv ? "age_5px" : "age, 5 px"},
                   {csv ? "error_5px" : "error, 5 px [px]"}};
  for (const std::string& path : arguments.tracks) {
    add_rows(table, path, arguments.protocol, truth, read(path), csv);
  }
  table.notes = {
      "Age: share of the true track's time until the first error beyond a threshold; mean over the tracks whose age is "
      "not 0 (their share is the inlier ratio) and over thresholds of 1 to 31 px. Expected age: mean of their product.",
      "full: a track that ends early has failed there, and a missing one has age 0. cropped: the true track is cut to "
      "the track's time, and missing ones do not count, as in the public evaluation of Messikommer et al. 2023."};
  arguments.out.write(format_table(table, format));
}

}  // namespace

void add_eval_tracks(CLI::App& app) {
  auto arguments = std::make_shared<EvalTracksArguments>();
  CLI::App* command =
      app.add_subcommand("eval-tracks", "Compare feature tracks with true ones: feature age, inlier ratio");
  command->add_option("groundtruth", arguments->truth, "True tracks, id t x y")->required()->type_name("GROUNDTRUTH");
  command->add_option("tracks", arguments->tracks, "Tracks with the same ids; a file each")
      ->required()
      ->type_name("TRACKS");
  command->add_option("--protocol", arguments->protocol, "How tracks that end early count")
      ->check(one_of(to_strings(kTrackProtocols)))
      ->capture_default_str();
  command->add_option("--format", arguments->format, "Format of the table")
      ->check(one_of({"text", "markdown", "csv", "latex"}))
      ->capture_default_str();
  add_text_output(*command, arguments->out);
  command->footer(
      "Tracks begin at their true tracks' first observations: the front-ends haste and str do with frontend.seeds.\n"
      "evbench run CONFIG --tracks writes the tracks of a run, tracks.txt.");
  command->callback([arguments] { execute(*arguments); });
}

}  // namespace evbench
