#include "core/plugin/library.hpp"

#include <dlfcn.h>
#include <fmt/format.h>

#include <algorithm>
#include <exception>
#include <filesystem>
#include <optional>
#include <string_view>
#include <vector>

#include "core/io/file_mapping.hpp"
#include "core/plugin/abi.hpp"
#include "core/support/error.hpp"

namespace evbench {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kMark = EVBENCH_PLUGIN_ABI_MARK;

std::vector<std::string_view> parts(std::string_view text) {
  if (text.starts_with(kMark)) text.remove_prefix(kMark.size());
  std::vector<std::string_view> result;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find("; "), text.size());
    result.push_back(text.substr(0, end));
    text.remove_prefix(std::min(end + 2, text.size()));
  }
  return result;
}

/// The parts in which two ABI texts differ.
std::string difference(std::string_view theirs, std::string_view ours) {
  const auto a = parts(theirs), b = parts(ours);
  std::string result;
  for (std::size_t i = 0; i < std::max(a.size(), b.size()); ++i) {
    const std::string_view there = i < a.size() ? a[i] : "nothing", here = i < b.size() ? b[i] : "nothing";
    if (there == here) continue;
    result += fmt::format("{}{} instead of {}", result.empty() ? "" : ", ", there, here);
  }
  return result;
}

void check_abi(const std::string& path, std::string_view theirs) {
  const std::string_view ours = plugin_abi();
  if (theirs == ours) return;
  throw InputError(fmt::format(
      "{}: was built for another evbench: it has {} (its \"{}\", this program's \"{}\"); expected the same: rebuild it "
      "with this evbench's evbench_add_plugin",
      path, difference(theirs, ours), theirs, ours));
}

/// The ABI text in a library's file. It is read before the library is loaded, because loading a library of another ABI
/// may end the program (one with a sanitizer does).
std::optional<std::string> abi_in_file(const std::string& path) {
  const FileMapping mapping(path);
  const std::string_view bytes(reinterpret_cast<const char*>(mapping.bytes().data()), mapping.bytes().size());
  for (std::size_t at = bytes.find(kMark); at != bytes.npos; at = bytes.find(kMark, at + 1)) {
    const std::string_view text = bytes.substr(at, bytes.find('\0', at) - at);
    if (text.size() > kMark.size()) return std::string(text);
  }
  return std::nullopt;
}

/// The dynamic linker's error message without the leading path.
std::string linker_error(const std::string& path) {
  const char* error = dlerror();  // NOLINT(concurrency-mt-unsafe): per thread in glibc
  std::string text = error != nullptr ? error : "unknown error";
  if (text.starts_with(path + ": ")) text.erase(0, path.size() + 2);
  return text;
}

template <class Function>
Function function_of(void* library, const std::string& path, const char* name) {
  void* const found = dlsym(library, name);
  if (found == nullptr) {
    throw InputError(
        fmt::format("{}: is no plugin of evbench: it has no function {}; expected a library that "
                    "evbench_add_plugin made",
                    path, name));
  }
  return reinterpret_cast<Function>(found);
}

template <class Interface>
bool has_of(const Registry<Interface>& registry, const std::string& origin) {
  return std::ranges::any_of(registry.entries(), [&](const auto& item) { return item.second.origin == origin; });
}

bool has_plugins_of(const Plugins& plugins, const std::string& origin) {
  return has_of(plugins.of<Source>(), origin) || has_of(plugins.of<FrontEnd>(), origin) ||
         has_of(plugins.of<BackEnd>(), origin);
}

void load(Plugins& plugins, const std::string& path) {
  if (has_plugins_of(plugins, path)) return;
  if (const auto text = abi_in_file(path)) check_abi(path, *text);
  void* const library = dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (library == nullptr) {
    throw InputError(
        fmt::format("{}: can't be loaded as a shared library: {}; expected a plugin that "
                    "evbench_add_plugin made",
                    path, linker_error(path)));
  }
  check_abi(path, function_of<const char* (*)()>(library, path, "evbench_plugin_abi")());
  const auto add = function_of<void (*)(Plugins&, const char*)>(library, path, "evbench_plugin_add");
  Plugins trial = plugins;  // discarded if the registration fails half-way
  try {
    add(trial, path.c_str());
  } catch (const InputError& error) {
    throw InputError(fmt::format("{}: {}", path, error.what()));
  } catch (const std::exception& error) {
    throw InputError(fmt::format("{}: its registration failed: {}", path, error.what()));
  } catch (...) {
    throw InputError(fmt::format("{}: its registration failed with an exception that is no std::exception", path));
  }
  if (!has_plugins_of(trial, path)) {
    throw InputError(fmt::format("{}: registers no plugin; expected a Registration in one of its sources", path));
  }
  plugins = std::move(trial);
}

/// The build command, if the missing library belongs into the build folder of a plugin's source; else empty.
std::string how_to_build(const fs::path& library) {
  std::error_code ignored;
  const fs::path build = fs::absolute(library, ignored).parent_path(), source = build.parent_path();
  if (source.empty() || !fs::exists(source / "CMakeLists.txt", ignored)) return "";
  const auto shown = [](const fs::path& path) { return path.lexically_proximate(fs::current_path()).string(); };
  return fmt::format(
      ". It is built by: cmake -S {0} -B {1} && cmake --build {1} (with -DCMAKE_PREFIX_PATH=DIR where evbench is not "
      "installed in the usual places)",
      shown(source), shown(build));
}

/// The library, or the libraries of a folder in the order of their names, with links resolved.
std::vector<std::string> libraries_at(const std::string& path) {
  if (!fs::exists(path)) {
    throw InputError(fmt::format("{}: no such file; expected a plugin's shared library, or a folder of them{}", path,
                                 how_to_build(path)));
  }
  if (!fs::is_directory(path)) return {fs::canonical(path).string()};
  std::vector<std::string> libraries;
  for (const auto& entry : fs::directory_iterator(path)) {
    if (entry.path().extension() == ".so" && entry.is_regular_file()) {
      libraries.push_back(fs::canonical(entry.path()).string());
    }
  }
  if (libraries.empty()) {
    throw InputError(fmt::format("{}: the folder has no shared library; expected plugins (*.so)", path));
  }
  std::ranges::sort(libraries);
  return libraries;
}

}  // namespace

void load_plugin_libraries(Plugins& plugins, const std::string& path) {
  for (const std::string& library : libraries_at(path)) load(plugins, library);
}

std::vector<std::string> unloaded_libraries(const Plugins& plugins, const std::string& path) {
  std::vector<std::string> libraries = libraries_at(path);
  std::erase_if(libraries, [&](const std::string& library) { return has_plugins_of(plugins, library); });
  return libraries;
}

}  // namespace evbench
