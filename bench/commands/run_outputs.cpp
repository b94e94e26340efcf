#include "bench/commands/run_outputs.hpp"

#include <fmt/format.h>

#include <filesystem>

#include "core/io/atomic_file.hpp"

namespace evbench {

CLI::Option* add_list_option(CLI::App& command, const std::string& name, std::vector<std::string>& items,
                             const std::string& text, const std::string& type) {
  return command.add_option(name, items, text)
      ->delimiter(',')
      ->allow_extra_args(false)  // so that folders may stand behind it
      ->type_name(type);
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
