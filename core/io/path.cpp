#include "core/io/path.hpp"

#include <fmt/format.h>

#include <cstdlib>
#include <filesystem>

#include "core/support/error.hpp"

namespace evbench {
namespace {

std::string environment(const std::string& name, const std::string& path) {
  const char* const value = std::getenv(name.c_str());
  if (value != nullptr && *value != '\0') return value;
  const char* const what =
      name == "EVBENCH_DATA" ? "the folder of the recordings" : "the part of the path that it replaces";
  throw InputError(fmt::format("{}: the environment variable {} is not set; set it to {}", path, name, what));
}

}  // namespace

std::string resolve_path(const std::string& path, const std::string& folder) {
  std::string expanded;
  std::size_t at = 0;
  while (true) {
    const std::size_t open = path.find("${", at);
    expanded += path.substr(at, open - at);
    if (open == std::string::npos) break;
    const std::size_t close = path.find('}', open);
    if (close == std::string::npos) throw InputError(fmt::format("{}: ${{ without a closing brace", path));
    expanded += environment(path.substr(open + 2, close - open - 2), path);
    at = close + 1;
  }
  return anchored_path(expanded, folder);
}

std::string anchored_path(const std::string& path, const std::string& folder) {
  if (folder.empty() || path.starts_with("${") || std::filesystem::path(path).is_absolute()) return path;
  return (std::filesystem::path(folder) / path).lexically_normal().string();
}

std::string follow_links(const std::string& path) {
  constexpr int kMost = 40;  // as the kernel
  std::filesystem::path at = path;
  std::error_code error;
  for (int i = 0; std::filesystem::is_symlink(at, error); ++i) {
    if (i == kMost) throw InputError(fmt::format("{}: is a symbolic link that leads in a circle", path));
    at = at.parent_path() / std::filesystem::read_symlink(at, error);
  }
  return at.string();
}

}  // namespace evbench
