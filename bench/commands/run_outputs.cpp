#include "bench/commands/run_outputs.hpp"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <charconv>
#include <cstdlib>
#include <filesystem>
#include <string_view>

#include "core/io/atomic_file.hpp"

namespace evbench {

CLI::Option* add_list_option(CLI::App& command, const std::string& name, std::vector<std::string>& items,
                             const std::string& text, const std::string& type) {
  return command.add_option(name, items, text)
      ->delimiter(',')
      ->allow_extra_args(false)  // so that folders may follow
      ->type_name(type);
}

std::size_t text_width() {
  constexpr std::size_t kUsual = 120;
  winsize size{};
  if (::isatty(STDOUT_FILENO) != 0 && ::ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0) {
    return size.ws_col;
  }
  const char* columns = std::getenv("COLUMNS");  // NOLINT(concurrency-mt-unsafe)
  const std::string_view text = columns == nullptr ? "" : columns;
  std::size_t width = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), width);
  return error == std::errc() && end == text.data() + text.size() && width > 0 ? width : kUsual;
}

void add_wide(CLI::App& command, TableLayout& layout, bool& wide) {
  layout.width = text_width();
  command.add_flag_callback(
      "--wide",
      [&layout, &wide] {
        layout.width = 0;
        wide = true;
      },
      "Print all columns of a text table; by default as many as fit the terminal ($COLUMNS, or 120, without one)");
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
