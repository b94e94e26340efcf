#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <tuple>
#include <vector>

#include "core/plugin/backend.hpp"
#include "core/plugin/frontend.hpp"
#include "core/plugin/options.hpp"
#include "core/plugin/source.hpp"

namespace evbench {

/// The name and the context of a kind of plugin.
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

/// Origin of the plugins that the program itself registers.
inline constexpr const char* kBuiltIn = "built in";

/// A new set of options of a plugin: the declaration, the files that they name in addition to path() options, and the
/// commands that they start.
struct DeclaredOptions {
  OptionSet& set;
  std::function<std::vector<std::string>()> files;
  std::function<std::vector<std::string>(const std::string& place)> commands;
};

/// Properties of a plugin of any kind.
struct PluginEntry {
  std::string text;          ///< one line for `evbench list`
  std::string origin;        ///< kBuiltIn, or the library's path
  int version = 1;           ///< of its results: raised when the same options give different results
  bool reads_events = true;  ///< front-ends: the events are part of a run's identity

  /// Calls its argument with new options of the plugin.
  std::function<void(const std::function<void(const DeclaredOptions&)>&)> with_options;

  std::string describe() const;  ///< table of its options
  Json schema() const;           ///< JSON Schema of its options
  /// Checks the options, adds defaults, and makes relative paths relative to `folder`.
  Json resolve(const Json& options, const std::string& place, const std::string& folder) const;
  std::vector<std::string> files(const Json& options) const;  ///< named by resolved options, in their order
  /// Commands that the plugin starts with resolved options, as typed in a shell. Throws InputError for an invalid one.
  std::vector<std::string> commands(const Json& options, const std::string& place) const;
  Json identity(const Json& options) const;  ///< resolved options without file names: the files' content counts instead
};

/// The plugins of one kind by name.
template <class Interface>
class Registry {
 public:
  using Context = typename PluginKind<Interface>::Context;

  struct Entry : PluginEntry {
    std::function<std::unique_ptr<Interface>(const Json&, const Context&)> make;  ///< from resolved options
  };

  /// Throws InputError with both origins when the name is taken.
  void add(const std::string& name, Entry entry);

  /// Throws InputError with the nearest name for an unknown one; `place` is the place of the name in the config.
  const Entry& find(const std::string& name, const std::string& place) const;

  const std::map<std::string, Entry>& entries() const { return entries_; }

 private:
  std::map<std::string, Entry> entries_;
};

extern template class Registry<Source>;
extern template class Registry<FrontEnd>;
extern template class Registry<BackEnd>;

/// All plugins of a program; main owns them.
class Plugins {
 public:
  /// May plugins start commands, and may libraries be loaded that only a config names?
  bool external_code_allowed() const { return external_code_allowed_; }
  void refuse_external_code() { external_code_allowed_ = false; }

  template <class Interface>
  Registry<Interface>& of() {
    return std::get<Registry<Interface>>(registries_);
  }
  template <class Interface>
  const Registry<Interface>& of() const {
    return std::get<Registry<Interface>>(registries_);
  }

 private:
  std::tuple<Registry<Source>, Registry<FrontEnd>, Registry<BackEnd>> registries_;
  bool external_code_allowed_ = true;
};

}  // namespace evbench
