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

/// The origin of what the program itself registers.
inline constexpr const char* kBuiltIn = "built in";

/// Options of a plugin, fresh ones: what is declared, the files that they name besides those of path() options, and the
/// commands that they start.
struct DeclaredOptions {
  OptionSet& set;
  std::function<std::vector<std::string>()> files;
  std::function<std::vector<std::string>(const std::string& place)> commands;
};

/// What is known of a plugin of any kind.
struct PluginEntry {
  std::string text;          ///< one line for `evbench list`
  std::string origin;        ///< kBuiltIn, or the library's path
  int version = 1;           ///< of what it computes: raised when the same options give other results
  bool reads_events = true;  ///< front-ends: the content of the source's events counts for a run

  /// Calls its argument with the plugin's options.
  std::function<void(const std::function<void(const DeclaredOptions&)>&)> with_options;

  std::string describe() const;  ///< table of its options
  Json schema() const;           ///< JSON Schema of its options
  /// Options checked, completed with defaults, relative paths taken from the folder.
  Json resolve(const Json& options, const std::string& place, const std::string& folder) const;
  std::vector<std::string> files(const Json& options) const;  ///< that resolved options name, in their order
  /// Commands that a plugin of resolved options starts, as one would type them. Throws InputError for what is none.
  std::vector<std::string> commands(const Json& options, const std::string& place) const;
  Json identity(const Json& options) const;  ///< resolved options without the names of files: their content counts
};

/// The plugins of one kind by name.
template <class Interface>
class Registry {
 public:
  using Context = typename PluginKind<Interface>::Context;

  struct Entry : PluginEntry {
    std::function<std::unique_ptr<Interface>(const Json&, const Context&)> make;  ///< from resolved options
  };

  /// Throws InputError when there is one of that name already, naming where both are from.
  void add(const std::string& name, Entry entry);

  /// Throws InputError with the nearest name for an unknown one; `place` is where the name stands.
  const Entry& find(const std::string& name, const std::string& place) const;

  const std::map<std::string, Entry>& entries() const { return entries_; }

 private:
  std::map<std::string, Entry> entries_;
};

extern template class Registry<Source>;
extern template class Registry<FrontEnd>;
extern template class Registry<BackEnd>;

/// All plugins that a program knows: main owns them.
class Plugins {
 public:
  /// Whether plugins may be made that start commands, and libraries be loaded that a config alone names.
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
