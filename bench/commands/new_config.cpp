#include "bench/recordings/new_config.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>

#include "bench/commands/commands.hpp"
#include "bench/commands/progress_line.hpp"
#include "core/io/atomic_file.hpp"
#include "core/support/interruption.hpp"

namespace evbench {
namespace {

struct NewConfigArguments {
  std::string recording, out;
  NewConfigOptions options;
  bool force = false, quiet = false;
};

/// The recording's name with .json, in the working folder.
std::string usual_name(const std::string& recording) {
  const std::filesystem::path path = std::filesystem::absolute(recording).lexically_normal();
  const std::filesystem::path name = path.has_filename() ? path.filename() : path.parent_path().filename();
  return name.stem().string() + ".json";
}

void execute(const NewConfigArguments& arguments, const Plugins& plugins) {
  const Interruption interruption(arguments.recording + ": interrupted; nothing was written");
  const std::string out = arguments.out.empty() ? usual_name(arguments.recording) : arguments.out;
  check_outputs({out}, {arguments.recording, arguments.options.calibration, arguments.options.ground_truth},
                arguments.force);
  RecordingSummary summary;
  {
    ProgressLine line(arguments.recording, arguments.quiet);
    summary =
        summarise(arguments.recording, {.read = arguments.options.read}, [&](std::int64_t events, std::int64_t t) {
          line.update(fmt::format("{:.1f} million events, {:.2f} s", static_cast<double>(events) * 1e-6,
                                  static_cast<double>(t) * 1e-6));
        });
  }
  write_file(out, new_config(arguments.recording, summary, arguments.options, out, plugins));
  if (!arguments.quiet) fmt::print("written: {0}\nevbench run {0}\n", out);
}

}  // namespace

void add_new_config(CLI::App& app, const Plugins& plugins) {
  auto arguments = std::make_shared<NewConfigArguments>();
  CLI::App* command = app.add_subcommand("new-config", "Write a config for your own recording, from its contents");
  command->add_option("recording", arguments->recording, "File or folder, of any format that evbench reads")
      ->required()
      ->type_name("RECORDING");
  command->add_option("--out", arguments->out, "The config; by default the recording's name with .json, here")
      ->type_name("FILE");
  command
      ->add_option("--calibration", arguments->options.calibration,
                   "Calibration, instead of that in or next to the recording: fx fy cx cy k1 k2 p1 p2 k3, or YAML of "
                   "Kalibr, ROS or OpenCV")
      ->type_name("FILE");
  command
      ->add_option("--ground-truth", arguments->options.ground_truth,
                   "Ground truth, likewise: TUM, EuRoC, KITTI, or named columns")
      ->type_name("FILE");
  command->add_flag("--force", arguments->force, "Replace the config where it exists");
  command->add_flag("--quiet", arguments->quiet, "Print nothing but errors");
  add_read_options(*command, arguments->options.read);
  command->footer("The recording is read once. The config has comments, and runs as it is: evbench run FILE.");
  command->callback([arguments, &plugins] { execute(*arguments, plugins); });
}

}  // namespace evbench
