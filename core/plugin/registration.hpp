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

/// The registrations of one program or shared library. Hidden symbol, so that each has its own list.
__attribute__((visibility("hidden"))) inline std::vector<AddPlugin>& registrations() {
  static std::vector<AddPlugin> list;
  return list;
}

template <class Options>
concept NamesFiles = requires(const Options& options) {
  { options.files() } -> std::same_as<std::vector<std::string>>;
};

template <class Options>
concept NamesCommands = requires(const Options& options) {
  { options.commands("") } -> std::same_as<std::vector<std::string>>;
};

template <class Plugin>
concept DeclaresReadsEvents = requires {
  Plugin::reads_events;
};

}  // namespace detail

/// Registers a plugin with one line in its own .cpp, built in or in a shared library:
///
///   const Registration<BackEnd, GpMap> registration("gp_map", "asynchronous MAP under a GP prior (Liu et al. 2022)");
///
/// GpMap has `using Options = ...` (see OptionSet) and a constructor (Options, const Context&), Context being
/// PluginKind<...>::Context. Raise `version` when the same options give different results, so that results of the old
/// version are not reused. Files that path() options name are part of a run's identity. Options may have
/// `std::vector<std::string> files() const` for further files. Options of a plugin that starts commands must have
/// `std::vector<std::string> commands(const std::string& place) const`: the commands are announced before they start,
/// and the user can refuse them. A front-end that does not read the source's events declares
/// `static constexpr bool reads_events = false;`. A program's plugins are CMake OBJECT libraries, so that the linker
/// keeps their registration.
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

  static std::vector<std::string> files_of([[maybe_unused]] const Options& options) {
    if constexpr (detail::NamesFiles<Options>) return options.files();
    return {};
  }

  static std::vector<std::string> commands_of([[maybe_unused]] const Options& options,
                                              [[maybe_unused]] const std::string& place) {
    if constexpr (detail::NamesCommands<Options>) return options.commands(place);
    return {};
  }

  static typename Registry<Interface>::Entry entry() {
    using Context = typename PluginKind<Interface>::Context;
    typename Registry<Interface>::Entry entry;
    if constexpr (detail::DeclaresReadsEvents<Plugin>) entry.reads_events = Plugin::reads_events;
    entry.with_options = [](const std::function<void(const DeclaredOptions&)>& use) {
      Options options;
      OptionSet set;
      options.declare(set);
      use({set, [&options] { return files_of(options); },
           [&options](const std::string& place) { return commands_of(options, place); }});
    };
    entry.make = [](const Json& json, const Context& context) -> std::unique_ptr<Interface> {
      return std::make_unique<Plugin>(read_options<Options>(json, context.place), context);
    };
    return entry;
  }
};

/// Adds the plugins that this program or shared library registers. `origin` names it in messages.
__attribute__((visibility("hidden"))) inline void add_registered_plugins(Plugins& plugins, const std::string& origin) {
  for (const detail::AddPlugin& add : detail::registrations()) add(plugins, origin);
}

/// The plugins of this program alone, for tests.
__attribute__((visibility("hidden"))) inline Plugins registered_plugins() {
  Plugins plugins;
  add_registered_plugins(plugins, kBuiltIn);
  return plugins;
}

}  // namespace evbench
