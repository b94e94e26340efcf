#include "bench/commands/commands.hpp"

namespace evbench {

void add_commands(CLI::App& app, Plugins& plugins, int& exit_code) {
  add_run(app, plugins, exit_code);
  add_sweep(app, plugins, exit_code);
  add_status(app, exit_code);
  add_task(app, plugins, exit_code);
  add_reproduce(app, plugins, exit_code);
  add_eval(app);
  add_eval_tracks(app);
  add_score(app);
  add_table(app);
  add_compare(app);
  add_figure(app);
  add_export(app, plugins);
  add_list(app, plugins);
  add_describe(app, plugins);
  add_solve(app);
  add_info(app, plugins);
  add_convert(app, plugins);
  add_dataset(app);
  add_render(app, plugins);
  add_report(app);
  add_new_config(app, plugins);
  add_new_plugin(app, plugins);
  add_check_plugin(app, plugins, exit_code);
  add_help(app);
}

}  // namespace evbench
