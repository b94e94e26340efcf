#include "bench/new_plugin/new_plugin.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <string_view>

#include "bench/new_plugin/templates.hpp"
#include "core/io/atomic_file.hpp"
#include "core/support/error.hpp"

namespace evbench {
namespace {

namespace fs = std::filesystem;

bool is_lower(char c) { return c >= 'a' && c <= 'z'; }
bool is_digit(char c) { return c >= '0' && c <= '9'; }

void check_name(const std::string& name) {
  const bool fits = !name.empty() && is_lower(name.front()) &&
                    std::ranges::all_of(name, [](char c) { return is_lower(c) || is_digit(c) || c == '_'; });
  if (!fits) {
    throw InputError(fmt::format(
        "new-plugin: \"{}\" can't name a plugin; expected a lower-case letter, then such letters, digits and _", name));
  }
  constexpr std::array<std::string_view, 10> kReserved = {
      "all",        "clean",         "edit_cache", "help",           "install",
      "preinstall", "rebuild_cache", "package",    "package_source", "test"};
  if (std::ranges::find(kReserved, name) != kReserved.end()) {
    throw InputError(fmt::format("new-plugin: \"{}\" is a name that CMake reserves; expected another", name));
  }
}

/// my_tracker: MyTracker.
std::string class_name(const std::string& name) {
  std::string result;
  bool begins = true;
  for (const char c : name) {
    if (c != '_') result += begins && is_lower(c) ? static_cast<char>(c - 'a' + 'A') : c;
    begins = c == '_';
  }
  return result;
}

std::string replaced(std::string text, std::string_view what, const std::string& by) {
  for (std::size_t at = text.find(what); at != text.npos; at = text.find(what, at + by.size())) {
    text.replace(at, what.size(), by);
  }
  return text;
}

void check_folder(const std::string& folder) {
  if (!fs::exists(folder)) return;
  if (!fs::is_directory(folder) || !fs::is_empty(folder)) {
    throw InputError(fmt::format("{}: is there already; expected a new folder, or an empty one", folder));
  }
  if (fs::equivalent(folder, fs::current_path())) {  // replacing it would leave the shell in a deleted folder
    throw InputError(fmt::format("{}: is the current folder; expected another", folder));
  }
}

std::string without_slash(const std::string& folder) {
  const fs::path path = fs::absolute(folder).lexically_normal();
  return (path.has_filename() ? path : path.parent_path()).string();
}

}  // namespace

void write_new_plugin(const std::string& kind, const std::string& name, const std::string& folder) {
  check_name(name);
  check_folder(folder);
  AtomicFolder result(without_slash(folder));
  for (const TemplateFile& file : template_files()) {
    if (file.kind != kind) continue;
    const std::string file_name =
        file.name == "gitignore" ? ".gitignore" : replaced(std::string(file.name), "NAME", name);
    result.write(file_name, replaced(replaced(std::string(file.text), "ClassName", class_name(name)), "NAME", name));
  }
  result.commit();
}

}  // namespace evbench
