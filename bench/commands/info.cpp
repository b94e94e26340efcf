#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>

#include "bench/commands/commands.hpp"
#include "bench/commands/progress_line.hpp"
#include "bench/recordings/config_events.hpp"
#include "bench/recordings/summary.hpp"
#include "core/support/error.hpp"
#include "core/support/json.hpp"

namespace evbench {
namespace {

struct InfoArguments {
  std::string file;
  StreamOptions options;
  bool json = false, quiet = false;
};

void execute(const InfoArguments& arguments) {
  RecordingSummary summary;
  StreamOptions options = arguments.options;
  options.read.lenient = true;  // faults are what the summary shows
  {
    ProgressLine line(arguments.file, arguments.quiet);
    summary = summarise(arguments.file, options, [&](std::int64_t events, std::int64_t t) {
      line.update(fmt::format("{:.1f} million events, {:.2f} s", static_cast<double>(events) * 1e-6,
                              static_cast<double>(t) * 1e-6));
    });
  }
  fmt::print("{}", arguments.json ? dump_json(summary_json(arguments.file, summary), 2) + "\n"
                                  : format_summary(arguments.file, summary));
  if (summary.large_loss && !arguments.options.read.lenient) throw InputError(*summary.large_loss);
}

}  // namespace

void add_read_options(CLI::App& command, ReadOptions& options) {
  command.add_option("--topic", options.topic,
                     "Topic of the events in a bag, or their group in an HDF5 file; default: the first");
  command.add_option("--ground-truth-topic", options.ground_truth_topic,
                     "Topic of the ground-truth poses in a bag; default: the event camera's by its name");
  command.add_option("--camera-info-topic", options.camera_info_topic,
                     "Topic of the camera info in a bag; default: the event camera's by its size and name");
  auto* strict =
      command.add_flag("--strict", options.strict,
                       "The first fault of the recording is an error; by default faults are skipped and counted");
  command
      .add_flag("--lenient", options.lenient,
                "Accept any number of skipped events; by default more than a tenth is an error")
      ->excludes(strict);
  command
      .add_option("--width", options.width,
                  "Sensor's width [px], if the file of events does not have it; overrides files next to it")
      ->check(CLI::Range(1, 65536));
  command.add_option("--height", options.height, "Sensor's height [px], likewise")->check(CLI::Range(1, 65536));
  command
      .add_option("--columns", options.columns,
                  "Columns of text or of HDF5 rows in their order, if they are not recognised: t (or t_s, t_ms, t_us, "
                  "t_ns), x, "
                  "y, p; other names are skipped. For single columns of HDF5 only the unit counts")
      ->type_name("t,x,y,p");
}

void add_info(CLI::App& app, const Plugins& plugins) {
  auto arguments = std::make_shared<InfoArguments>();
  arguments->options.open = recordings_and_configs(plugins);
  CLI::App* command = app.add_subcommand("info", "Describe a recording of events: format, counts, rates, faults");
  command->add_option("file", arguments->file, "File or folder, of any format that evbench reads; -: standard input")
      ->required()
      ->type_name("FILE");
  command->add_flag("--json", arguments->json, "Print JSON");
  command->add_flag("--quiet", arguments->quiet, "Show no progress");
  add_read_options(*command, arguments->options.read);
  command->footer(
      "Faults are events that are skipped: out of time order, outside the sensor, or in damaged parts of the file. "
      "Exit "
      "code 2 if they are more than a tenth, unless --lenient.");
  command->callback([arguments] { execute(*arguments); });
}

}  // namespace evbench
