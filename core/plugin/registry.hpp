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

/// The plugins of one kind by name.
template <class Interface>
class Registry {
 public:
  using Context = typename PluginKind<Interface>::Context;

  struct Entry {
    std::string text;                       ///< one line for `evbench list`
    std::string origin;                     ///< kBuiltIn, or the library's path
    int version = 1;                        ///< of what it computes: raised when the same options give other results
    bool reads_events = true;               ///< front-ends: the content of the source's events counts for a run
    std::function<std::string()> describe;  ///< table of its options
    std::function<Json()> schema;           ///< JSON Schema of its options
    /// (options, place, folder): checked, completed with defaults, relative paths taken from the folder.
    std::function<Json(const Json&, const std::string&, const std::string&)> resolve;
    std::function<std::vector<std::string>(const Json&)> files;  ///< that resolved options name, in their order
    std::function<Json(const Json&)> identity;  ///< resolved options without the names of files: their content counts
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
};

}  // namespace evbench
