#include "bench/render/render.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>

#include "bench/commands/commands.hpp"
#include "bench/commands/name_check.hpp"
#include "bench/commands/number_check.hpp"
#include "bench/commands/progress_line.hpp"
#include "bench/commands/time_range.hpp"
#include "bench/recordings/config_events.hpp"
#include "core/io/atomic_file.hpp"
#include "core/support/error.hpp"
#include "core/support/interruption.hpp"
#include "eval/names.hpp"

namespace evbench {
namespace {

RenderMode parse_mode(const std::string& name) {
  if (name == "time_surface") return RenderMode::time_surface;
  return name == "compensated" ? RenderMode::compensated : RenderMode::events;
}

struct RenderArguments {
  std::string in, out, mode = "events";
  TimeRangeArguments range;
  std::optional<double> duration, decay, tail;  // [ms]
  std::string quaternion = "auto";
  bool quiet = false, force = false;
  RenderOptions options;
};

RenderOptions render_options(const RenderArguments& arguments) {
  RenderOptions options = arguments.options;
  set_time_range(arguments.range, options.stream);
  options.mode = parse_mode(arguments.mode);
  options.quaternion =
      parse_name<QuaternionOrder>(kQuaternionOrderNames, arguments.quaternion, "order of a quaternion");
  if (arguments.duration) options.duration = *arguments.duration * 1e-3;
  if (arguments.decay) options.decay = *arguments.decay * 1e-3;
  if (arguments.tail) options.tail = *arguments.tail * 1e-3;
  return options;
}

void execute(const RenderArguments& arguments) {
  const RenderOptions& files = arguments.options;
  check_outputs({arguments.out},
                {arguments.in, files.tracks, files.trajectory, files.calibration, files.run, files.beside},
                arguments.force);
  if (arguments.decay && arguments.mode != "time_surface") throw InputError("--decay: is for --mode time_surface");
  RenderReport report;
  {
    const Interruption interruption(arguments.out + ": interrupted; nothing was written");
    ProgressLine line(arguments.out, arguments.quiet);
    report = render(arguments.in, arguments.out, render_options(arguments), [&](std::int64_t pictures, std::int64_t t) {
      line.update(fmt::format("{} pictures, {:.3f} s", pictures, static_cast<double>(t) * 1e-6));
    });
  }
  if (arguments.quiet) return;
  for (const std::string& remark : report.remarks) fmt::print(stderr, "evbench render: {}\n", remark);
  for (const auto& [kind, fault] : report.faults) {
    fmt::print("left out: {} {}; the first: {}\n", fault.count, kind, fault.first);
  }
  fmt::print("written: {}, {} {} of {}x{} pixels\n", arguments.out, report.pictures,
             report.pictures == 1 ? "picture" : "pictures", report.size.width, report.size.height);
}

void add_time_options(CLI::App& command, RenderArguments& arguments) {
  RenderOptions& options = arguments.options;
  add_time_range(command, arguments.range, options.stream);
  auto* duration = command.add_option("--duration", arguments.duration,
                                      "Duration of the events in a picture [ms]; default: 20, or from --from to --to; "
                                      "in a video 1 to 10 times the time between pictures");
  duration->check(in_range(0.001, 1e9));
  command.add_option("--count", options.count, "Number of events in a picture, instead of a duration")
      ->check(CLI::Range(1, 100000000))
      ->excludes(duration);
  command.add_option("--fps", options.fps, "Pictures per second of playback")
      ->check(in_range(0.1, 1000.0))
      ->capture_default_str();
  command.add_option("--speed", options.speed, "Speed of playback: 0.1 is ten times slower than real time")
      ->check(in_range(1e-6, 1e6))
      ->capture_default_str();
}

void add_mode_options(CLI::App& command, RenderArguments& arguments) {
  RenderOptions& options = arguments.options;
  command
      .add_option("--mode", arguments.mode,
                  "events: red (brighter) and blue (darker), the newest on top; time_surface: older events are "
                  "fainter; compensated: events are moved along the camera's motion to one time")
      ->check(one_of({"events", "time_surface", "compensated"}))
      ->type_name("NAME")
      ->capture_default_str();
  command.add_option("--decay", arguments.decay, "Time constant of time surfaces [ms]; default: 30")
      ->check(in_range(0.001, 1e9));
  auto* trajectory =
      command.add_option("--trajectory", options.trajectory,
                         "Motion for compensation (TUM, T_world_camera); default: the recording's ground truth");
  trajectory->type_name("FILE");
  command
      .add_option("--quaternion", arguments.quaternion,
                  "Order of its quaternion's columns; auto: by their names or number")
      ->check(one_of(to_strings(kQuaternionOrderNames)))
      ->needs(trajectory)
      ->capture_default_str();
  command
      .add_option("--calib", options.calibration,
                  "Calibration for compensation and for a run's landmarks, text or YAML; default: the recording's")
      ->type_name("FILE");
  command.add_option("--camera", options.camera, "Which camera of a --calib that has several (Kalibr)")
      ->type_name("NAME");
  command
      .add_option("--depth", options.depth,
                  "Also compensate translation, for a plane at this depth [m] in front of the camera")
      ->check(in_range(1e-6, 1e9));
}

void add_picture_options(CLI::App& command, RenderArguments& arguments) {
  RenderOptions& options = arguments.options;
  auto* tracks = command.add_option("--tracks", options.tracks, "Draw these feature tracks (id t x y) over the events");
  tracks->type_name("FILE");
  command.add_option("--tail", arguments.tail, "Length of a track's tail [ms]; default: 100")
      ->check(in_range(0.001, 1e9))
      ->needs(tracks);
  command
      .add_option("--run", options.run,
                  "Draw a run (its folder, made by evbench run --tracks): tracks, landmarks that are tracked (rings), "
                  "re-associated (bold rings) and lost (crosses), and the trajectory with the ground truth")
      ->type_name("DIR")
      ->excludes(tracks);
  command.add_option("--beside", options.beside, "Another recording, drawn to the right at the same times")
      ->type_name("FILE");
  command
      .add_option("--scale", options.scale,
                  "Enlarge each pixel of the sensor to N x N; default: until the sensor is 640 pixels wide")
      ->check(CLI::Range(1, 32))
      ->type_name("N");
  command.add_flag("--dark", options.dark, "On a dark background");
  command.add_flag(
      "--time", options.time,
      "Write the time into the lower left corner: the end of the picture's events, or the time to which they are "
      "moved");
}

}  // namespace

void add_render(CLI::App& app, const Plugins& plugins) {
  auto arguments = std::make_shared<RenderArguments>();
  arguments->options.stream.open = recordings_and_configs(plugins);
  CLI::App* command = app.add_subcommand("render", "Draw a recording of events: pictures (PNG) and video (MP4)");
  command->add_option("in", arguments->in, "File or folder, of any format that evbench reads; -: standard input")
      ->required()
      ->type_name("FILE");
  command->add_option("out", arguments->out, "NAME.png: one picture; NAME.mp4: a video; NAME/: a folder of pictures")
      ->required()
      ->type_name("OUT");
  add_time_options(*command, *arguments);
  add_mode_options(*command, *arguments);
  add_picture_options(*command, *arguments);
  command->add_flag("--force", arguments->force, "Replace OUT where it exists");
  command->add_flag("--quiet", arguments->quiet, "Print nothing but errors");
  add_read_options(*command, arguments->options.stream.read);
  command->footer(
      "OUT appears when it is complete. A sensor of unknown size gets the size that its events need; --width and "
      "--height set it. Times of tracks and trajectory are the recording's own, before --rebase.");
  command->callback([arguments] { execute(*arguments); });
}

}  // namespace evbench
