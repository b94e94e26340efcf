#include "bench/commands/run_outputs.hpp"

#include <fmt/format.h>

#include <filesystem>

#include "bench/commands/failures.hpp"
#include "core/io/atomic_file.hpp"
#include "eval/find_runs.hpp"

namespace evbench {

void add_folders(CLI::App& command, std::vector<std::string>& folders) {
  command.add_option("folders", folders, "Folders of runs, searched with all folders below")
      ->required()
      ->type_name("DIR");
}

CLI::Option* add_list_option(CLI::App& command, const std::string& name, std::vector<std::string>& items,
                             const std::string& text, const std::string& type) {
  return command.add_option(name, items, text)
      ->delimiter(',')
      ->allow_extra_args(false)  // so that folders may stand behind it
      ->type_name(type);
}

void use_runs(const std::vector<std::string>& folders, const std::function<void(std::vector<RunRecord>&)>& use) {
  std::vector<std::string> unreadable;
  std::vector<RunRecord> runs = find_runs(folders, &unreadable);
  if (!runs.empty()) use(runs);
  throw_together(unreadable);
}

void TextOutput::check() const {
  const std::filesystem::path folder = std::filesystem::path(file).parent_path();  // of a run, perhaps
  check_outputs({file}, {folder / "metrics.json", folder / "config.json"}, force);
}

void TextOutput::write(const std::string& text) const {
  if (file.empty()) {
    fmt::print("{}", text);
  } else {
    write_file(file, text);
  }
}

void add_text_output(CLI::App& command, TextOutput& output) {
  command.add_option("--out", output.file, "Write to this file instead of the terminal")->type_name("FILE");
  command.add_flag("--force", output.force, "Replace the file of --out where it exists");
}

}  // namespace evbench
