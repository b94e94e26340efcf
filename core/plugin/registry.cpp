#include "core/plugin/registry.hpp"

#include <fmt/format.h>

#include "core/support/error.hpp"
#include "core/support/json.hpp"
#include "core/support/nearest.hpp"

namespace evbench {

std::string PluginEntry::describe() const {
  std::string result;
  with_options([&](const DeclaredOptions& options) { result = options.set.describe(); });
  return result;
}

Json PluginEntry::schema() const {
  Json result;
  with_options([&](const DeclaredOptions& options) { result = options.set.schema(); });
  return result;
}

Json PluginEntry::resolve(const Json& options, const std::string& place, const std::string& folder) const {
  Json result;
  with_options([&](const DeclaredOptions& declared) {
    declared.set.read(options, place);
    declared.set.anchor_paths(folder);
    result = declared.set.write();
  });
  return result;
}

std::vector<std::string> PluginEntry::files(const Json& options) const {
  std::vector<std::string> result;
  with_options([&](const DeclaredOptions& declared) {
    declared.set.read(options, "options");
    result = declared.set.paths();
    for (std::string& file : declared.files()) result.push_back(std::move(file));
  });
  return result;
}

std::vector<std::string> PluginEntry::commands(const Json& options, const std::string& place) const {
  std::vector<std::string> result;
  with_options([&](const DeclaredOptions& declared) {
    declared.set.read(options, place);
    result = declared.commands(place);
  });
  return result;
}

Json PluginEntry::identity(const Json& options) const {
  Json result;
  with_options([&](const DeclaredOptions& declared) {
    declared.set.read(options, "options");
    result = declared.set.write_without_paths();
  });
  return result;
}

template <class Interface>
void Registry<Interface>::add(const std::string& name, Entry entry) {
  const std::string origin = entry.origin;
  const auto [place, added] = entries_.try_emplace(name, std::move(entry));
  if (added) return;
  throw InputError(fmt::format("two {}s are called \"{}\": one is {}, the other {}; expected names of their own",
                               PluginKind<Interface>::name, name, place->second.origin, origin));
}

template <class Interface>
auto Registry<Interface>::find(const std::string& name, const std::string& place) const -> const Entry& {
  const auto found = entries_.find(name);
  if (found != entries_.end()) return found->second;
  std::vector<std::string> names;
  for (const auto& [known, entry] : entries_) names.push_back(known);
  throw InputError(
      fmt::format("{}: no {} is called \"{}\"{} (an external one must be loaded: by --plugin LIBRARY, the variable "
                  "EVBENCH_PLUGINS or the "
                  "key \"plugins\" of a config)",
                  place, PluginKind<Interface>::name, name, suggestion(name, names)));
}

template class Registry<Source>;
template class Registry<FrontEnd>;
template class Registry<BackEnd>;

}  // namespace evbench
