#include "core/plugin/registry.hpp"

#include <fmt/format.h>

#include "core/support/error.hpp"
#include "core/support/nearest.hpp"

namespace evbench {

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
      fmt::format("{}: no {} is called \"{}\"{} (one from outside must be loaded: by --plugin LIBRARY, the variable "
                  "EVBENCH_PLUGINS or the "
                  "key \"plugins\" of a config)",
                  place, PluginKind<Interface>::name, name, suggestion(name, names)));
}

template class Registry<Source>;
template class Registry<FrontEnd>;
template class Registry<BackEnd>;

}  // namespace evbench
