#pragma once

#include <fmt/format.h>

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "core/plugin/backend.hpp"
#include "core/plugin/frontend.hpp"
#include "core/plugin/options.hpp"
#include "core/plugin/source.hpp"
#include "core/support/error.hpp"
#include "core/support/nearest.hpp"

namespace evbench {

/// What makes a plugin of a kind, besides its options.
struct SourceContext {
  std::uint64_t seed = 0;
  std::string folder;            ///< what relative paths in options refer to
  std::string place = "source";  ///< where the options stand, for messages: "config.json: source"
};
struct FrontEndContext {
  const Source& source;
  std::uint64_t seed = 0;
  std::string folder;              ///< what relative paths in options refer to
  std::string place = "frontend";  ///< where the options stand, for messages: "config.json: frontend"
};

template <class Interface>
struct PluginKind;
template <>
struct PluginKind<Source> {
  using Context = SourceContext;
  static constexpr const char* name = "source";
};
template <>
struct PluginKind<FrontEnd> {
  using Context = FrontEndContext;
  static constexpr const char* name = "frontend";
};
template <>
struct PluginKind<BackEnd> {
  using Context = BackEndContext;
  static constexpr const char* name = "backend";
};

/// The plugins of one kind by name. Each plugin registers itself with one line in its own .cpp:
///
///   const Registration<BackEnd, GpMap> registration("gp_map", "asynchronous MAP under a GP prior (Liu et al. 2022)");
///
/// where GpMap has `using Options = ...` (see OptionSet) and a constructor (Options, const BackEndContext&).
/// Plugins are CMake OBJECT libraries, so that the linker keeps their registration.
template <class Interface>
class Registry {
 public:
  using Context = typename PluginKind<Interface>::Context;

  struct Entry {
    std::string text;                       ///< one line for `evbench list`
    std::function<std::string()> describe;  ///< table of its options
    std::function<Json()> schema;           ///< JSON Schema of its options
    /// (options, place, folder): checked, completed with defaults, relative paths taken from the folder.
    std::function<Json(const Json&, const std::string&, const std::string&)> resolve;
    std::function<std::unique_ptr<Interface>(const Json&, const std::string&, const Context&)> make;
  };

  static Registry& instance() {
    static Registry registry;
    return registry;
  }

  void add(const std::string& name, Entry entry) { entries_.insert_or_assign(name, std::move(entry)); }
  const std::map<std::string, Entry>& entries() const { return entries_; }

  /// Throws InputError with the nearest name for an unknown one; `place` is where the name stands.
  const Entry& find(const std::string& name, const std::string& place) const {
    const auto found = entries_.find(name);
    if (found != entries_.end()) return found->second;
    std::vector<std::string> names;
    for (const auto& [known, entry] : entries_) names.push_back(known);
    throw InputError(
        fmt::format("{}: no {} is called \"{}\"{}", place, PluginKind<Interface>::name, name, suggestion(name, names)));
  }

 private:
  std::map<std::string, Entry> entries_;
};

template <class Interface, class Plugin>
struct Registration {
  Registration(const std::string& name, const std::string& text) {
    using Options = typename Plugin::Options;
    typename Registry<Interface>::Entry entry;
    entry.text = text;
    entry.describe = [] {
      Options options;
      OptionSet set;
      options.declare(set);
      return set.describe();
    };
    entry.schema = [] {
      Options options;
      OptionSet set;
      options.declare(set);
      return set.schema();
    };
    entry.resolve = [](const Json& json, const std::string& place, const std::string& folder) {
      Options options;
      OptionSet set;
      options.declare(set);
      set.read(json, place);
      set.anchor_paths(folder);
      return set.write();
    };
    entry.make = [](const Json& json, const std::string& place,
                    const typename Registry<Interface>::Context& context) -> std::unique_ptr<Interface> {
      return std::make_unique<Plugin>(read_options<Options>(json, place), context);
    };
    Registry<Interface>::instance().add(name, std::move(entry));
  }
};

}  // namespace evbench
