#pragma once

#include <concepts>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "core/plugin/registry.hpp"

namespace evbench {

namespace detail {

using AddPlugin = std::function<void(Plugins&, const std::string& origin)>;

/// The registrations of one program or shared library. Hidden: each has a list of its own, whoever loads it.
__attribute__((visibility("hidden"))) inline std::vector<AddPlugin>& registrations() {
  static std::vector<AddPlugin> list;
  return list;
}

template <class Options>
concept NamesFiles = requires(const Options& options) {
  { options.files() } -> std::same_as<std::vector<std::string>>;
};

template <class Plugin>
concept SaysWhetherItReadsEvents = requires {
  Plugin::reads_events;
};

}  // namespace detail

/// A plugin names itself with one line in its own .cpp, built in or in a shared library alike:
///
///   const Registration<BackEnd, GpMap> registration("gp_map", "asynchronous MAP under a GP prior (Liu et al. 2022)");
///
/// GpMap has `using Options = ...` (see OptionSet) and a constructor (Options, const Context&), Context being
/// PluginKind<...>::Context. `version` is raised when the same options come to give other results: runs of the old
/// version are then not taken for the new one's. Files that path() options name are part of a run's identity; Options
/// may have `std::vector<std::string> files() const` for others. A front-end that leaves the source's events alone says
/// `static constexpr bool reads_events = false;`.
/// A program's plugins are CMake OBJECT libraries, so that the linker keeps their registration.
template <class Interface, class Plugin>
class Registration {
 public:
  Registration(const std::string& name, const std::string& text, int version = 1) {
    detail::registrations().push_back([=](Plugins& plugins, const std::string& origin) {
      typename Registry<Interface>::Entry result = entry();
      result.text = text;
      result.origin = origin;
      result.version = version;
      plugins.of<Interface>().add(name, std::move(result));
    });
  }

 private:
  using Options = typename Plugin::Options;

  /// Calls use(options, set) with the options that a JSON object gives.
  template <class Use>
  static auto with(const Json& json, const std::string& place, Use use) {
    Options options;
    OptionSet set;
    options.declare(set);
    set.read(json, place);
    return use(options, set);
  }

  static typename Registry<Interface>::Entry entry() {
    using Context = typename PluginKind<Interface>::Context;
    typename Registry<Interface>::Entry entry;
    if constexpr (detail::SaysWhetherItReadsEvents<Plugin>) entry.reads_events = Plugin::reads_events;
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
      return with(json, place, [&](Options&, OptionSet& set) {
        set.anchor_paths(folder);
        return set.write();
      });
    };
    entry.files = [](const Json& json) {
      return with(json, "options", [](const Options& options, OptionSet& set) {
        std::vector<std::string> files = set.paths();
        if constexpr (detail::NamesFiles<Options>) {
          for (std::string& file : options.files()) files.push_back(std::move(file));
        }
        return files;
      });
    };
    entry.identity = [](const Json& json) {
      return with(json, "options", [](Options&, OptionSet& set) { return set.write_without_paths(); });
    };
    entry.make = [](const Json& json, const Context& context) -> std::unique_ptr<Interface> {
      return with(json, context.place,
                  [&](const Options& options, OptionSet&) { return std::make_unique<Plugin>(options, context); });
    };
    return entry;
  }
};

/// Adds what this program or shared library registers. `origin` says whose it is, in messages.
__attribute__((visibility("hidden"))) inline void add_registered_plugins(Plugins& plugins, const std::string& origin) {
  for (const detail::AddPlugin& add : detail::registrations()) add(plugins, origin);
}

/// The plugins of this program alone: for tests.
__attribute__((visibility("hidden"))) inline Plugins registered_plugins() {
  Plugins plugins;
  add_registered_plugins(plugins, kBuiltIn);
  return plugins;
}

}  // namespace evbench
