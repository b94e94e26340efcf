#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <string>

#include "bench/commands/commands.hpp"
#include "bench/commands/exit_code.hpp"
#include "bench/sweep/sweep_status.hpp"

namespace evbench {

void add_status(CLI::App& app, int& exit_code) {
  auto folder = std::make_shared<std::string>();
  CLI::App* command = app.add_subcommand("status", "Show the progress and the failures of sweeps");
  command->add_option("folder", *folder, "Folder of a sweep, OUT/NAME, or of several, OUT")
      ->required()
      ->type_name("DIR");
  command->footer("Exit codes: 0 all done, 2 bad input, 3 some failed or are still to be done.");
  command->callback([folder, &exit_code] {
    for (const SweepStatus& sweep : read_sweep_status(*folder)) {
      fmt::print("{}: {} of {} done, {} failed, {} running, {} to do\n", sweep.folder, sweep.done, sweep.runs,
                 sweep.failed, sweep.running, sweep.missing);
      for (const TroubledRun& run : sweep.troubled) fmt::print("  {}\n", describe(run));
      if (sweep.others > 0) fmt::print("  {}\n", describe_others(sweep.others));
      if (sweep.done < sweep.runs) exit_code = kExitFailed;
    }
  });
}

}  // namespace evbench
