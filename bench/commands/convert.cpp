#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>

#include "bench/commands/commands.hpp"
#include "bench/commands/progress_line.hpp"
#include "bench/commands/time_range.hpp"
#include "bench/recordings/config_events.hpp"
#include "bench/recordings/conversion.hpp"
#include "core/events/writer.hpp"
#include "core/io/atomic_file.hpp"
#include "core/support/interruption.hpp"

namespace evbench {
namespace {

struct ConvertArguments {
  std::string in, out;
  TimeRangeArguments range;
  bool quiet = false, force = false;
  ConversionOptions options;
};

void execute(const ConvertArguments& arguments) {
  check_outputs({arguments.out}, {arguments.in}, arguments.force);  // early, as far as the files are known
  ConversionOptions options = arguments.options;
  options.force = arguments.force;
  set_time_range(arguments.range, options.stream);
  const Interruption interruption(arguments.out + ": interrupted; nothing was written");
  ConversionReport report;
  {
    ProgressLine line(arguments.in, arguments.quiet);
    report = convert(arguments.in, arguments.out, options, [&](std::int64_t events, std::int64_t t) {
      line.update(fmt::format("{:.1f} million events, {:.2f} s", static_cast<double>(events) * 1e-6,
                              static_cast<double>(t) * 1e-6));
    });
  }
  if (arguments.quiet) return;
  for (const std::string& text : report.unusable) fmt::print("left out: {}\n", text);
  for (const auto& [kind, fault] : report.faults) {
    fmt::print("left out: {} {}; the first: {}\n", fault.count, kind, fault.first);
  }
  if (report.outside > 0) fmt::print("left out: {} events that lie outside the undistorted image\n", report.outside);
  fmt::print("written: {} ({}), {} events\n", arguments.out, report.format, report.written);
}

std::string formats_text() {
  std::string text = "Formats that can be written, by the extension of OUT or by --format:\n";
  for (const WritableFormat& format : writable_formats()) {
    text += fmt::format("  {:<8}{:<6}{}\n", format.name, format.extension, format.description);
  }
  return text +
         "Only native keeps calibration, ground truth and header; text and hdf5 keep the sensor's size. Text begins\n"
         "with comments that give the size and the columns: grep -v '^#' removes them.\n"
         "OUT appears when it is complete; an interrupted conversion leaves an existing file as it was.\n"
         "Text can be written to a pipe or device: convert IN /dev/stdout --format text --quiet | head";
}

}  // namespace

void add_convert(CLI::App& app, const Plugins& plugins) {
  auto arguments = std::make_shared<ConvertArguments>();
  arguments->options.stream.open = recordings_and_configs(plugins);
  CLI::App* command = app.add_subcommand("convert", "Convert a recording of events: native cache, text, HDF5");
  command->add_option("in", arguments->in, "File or folder, of any format that evbench reads; -: standard input")
      ->required()
      ->type_name("IN");
  command->add_option("out", arguments->out, "File to write")->required()->type_name("OUT");
  command->add_option("--format", arguments->options.format, "Format of OUT, whatever its extension")
      ->type_name("NAME");
  add_time_range(*command, arguments->range, arguments->options.stream);
  command
      ->add_option("--undistort", arguments->options.undistort,
                   "Undistort events to the nearest pixel of the ideal pinhole camera; events outside it are left out. "
                   "CALIB: a calibration, text or YAML, or \"own\": the recording's")
      ->type_name("CALIB");
  command->add_option("--camera", arguments->options.camera, "Which camera of a CALIB that has several (Kalibr)")
      ->type_name("NAME");
  command->add_flag("--force", arguments->force, "Replace OUT where it exists");
  command->add_flag("--quiet", arguments->quiet, "Print nothing but errors");
  add_read_options(*command, arguments->options.stream.read);
  command->footer(formats_text());
  command->callback([arguments] { execute(*arguments); });
}

}  // namespace evbench
