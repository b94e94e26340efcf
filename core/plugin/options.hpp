#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <type_traits>
#include <variant>
#include <vector>

#include "core/support/json_fwd.hpp"

namespace evbench {

/// The options of a plain struct, declared once:
///
///   struct MyOptions {
///     double rate = 20.0;
///     enum class Loss { none, huber } loss = Loss::none;
///     void declare(OptionSet& set) {
///       set.add("rate", rate, "control states per second [Hz]").range(0.1, 1000.0);
///       set.add("loss", loss, {"none", "huber"}, "robust loss");
///     }
///   };
///
/// The declaration gives the reading of a JSON object (defaults, types, ranges, unknown keys), the writing of the
/// complete object, the text of `evbench describe`, and a JSON Schema. The set refers to the struct's members and must
/// not outlive the struct.
class OptionSet {
 public:
  using List = std::vector<double>;
  /// A member of an enumeration type, as a number.
  struct Enumerator {
    void* member;
    int (*get)(const void* member);
    void (*set)(void* member, int value);
  };
  using Target = std::variant<bool*, int*, std::int64_t*, double*, std::string*, Enumerator, List*, Json*>;

  class Option {
   public:
    Option& range(double minimum,
                  double maximum = std::numeric_limits<double>::infinity());  ///< closed; numbers, items
    Option& above(double minimum);                                            ///< open below: > minimum
    Option& choices(std::vector<std::string> values);
    Option& size(std::size_t count);  ///< number of items of a list; an empty list is valid if it is the default
    Option& rising();                 ///< the items of a list increase, e.g. [from, to]
    Option& required();               ///< no default: must be given
    Option& path();                   ///< text that names a file or folder, relative to the config's folder
    Option& folder();                 ///< likewise; its content is not part of a run's identity

   private:
    friend class OptionSet;
    std::string name_, text_;
    Target target_;
    double minimum_ = -std::numeric_limits<double>::infinity();
    double maximum_ = std::numeric_limits<double>::infinity();
    bool open_below_ = false, may_be_empty_ = false, rising_ = false, required_ = false, path_ = false, folder_ = false;
    std::vector<std::string> choices_;
    std::optional<std::size_t> size_;

    void read(const Json& value, const std::string& place);
    void check_number(double value, const std::string& place) const;
    std::string allowed() const;
    std::string type_name() const;
    void check_choice(const std::string& value, const std::string& place) const;
    Json value() const;
    Json schema() const;
  };

  OptionSet();
  OptionSet(OptionSet&& other) noexcept;
  ~OptionSet();

  /// `text` is a phrase with the unit in brackets. A Json target accepts any value.
  Option& add(const std::string& name, Target target, const std::string& text);
  template <class T>
  Option& add(const std::string& name, T& member, const std::string& text) {
    constexpr bool kIsTarget = std::is_constructible_v<Target, T*>;
    static_assert(!std::is_enum_v<T>,
                  "an option that is an enumeration needs the names of its values, for 0, 1, ...: "
                  "set.add(name, member, {\"none\", \"huber\"}, text)");
    static_assert(kIsTarget || std::is_enum_v<T>,
                  "an option is a bool, int, std::int64_t, double, std::string, std::vector<double>, Json, or an "
                  "enumeration with the names of its values; a struct of options is a group()");
    if constexpr (kIsTarget) {
      return add(name, Target(&member), text);
    } else {
      return options_.back();  // never compiled: the assertion fails first
    }
  }

  /// Adds an enumeration, written as text; `names` are those of its values 0, 1, ...
  template <class Enum>
  requires std::is_enum_v<Enum> Option& add(const std::string& name, Enum& member, std::vector<std::string> names,
                                            const std::string& text) {
    const Enumerator target{&member, [](const void* from) { return static_cast<int>(*static_cast<const Enum*>(from)); },
                            [](void* to, int value) { *static_cast<Enum*>(to) = static_cast<Enum>(value); }};
    return add(name, Target(target), text).choices(std::move(names));
  }

  /// Adds a nested object with its own options.
  template <class Struct>
  void group(const std::string& name, Struct& member, const std::string& text) {
    OptionSet set;
    member.declare(set);
    add_group(name, text, std::move(set));
  }

  /// At least one of these options (texts) must be given.
  void require_one_of(std::vector<std::string> names) { alternatives_.push_back(std::move(names)); }

  /// Sets the members from a JSON object; missing keys keep their defaults. `place` is the place of the object for
  /// messages ("config.json: backend"). Throws InputError for a value of a wrong type or out of range, an unknown key
  /// (with the nearest known one), a missing required key, and when none of several alternatives is given.
  void read(const Json& object, const std::string& place);

  /// Makes relative paths among the options relative to `folder`, so that they are valid from anywhere.
  void anchor_paths(const std::string& folder);

  Json write() const;                      ///< every option with its current value
  Json write_without_paths() const;        ///< likewise without the options that name files or folders
  std::vector<std::string> paths() const;  ///< the values of path() options, including groups
  Json schema() const;                     ///< JSON Schema (2020-12) of the object
  std::string describe() const;            ///< a readable table: name, type, default, range, text

 private:
  struct Group;
  void add_group(const std::string& name, const std::string& text, OptionSet set);
  void describe_rows(const std::string& prefix, std::vector<std::array<std::string, 4>>& rows) const;

  std::vector<Option> options_;
  std::vector<Group> groups_;
  std::vector<std::vector<std::string>> alternatives_;
};

struct OptionSet::Group {
  std::string name, text;
  OptionSet set;
};

// Defined here, where Group is a complete type.
inline OptionSet::OptionSet() = default;
inline OptionSet::OptionSet(OptionSet&&) noexcept = default;
inline OptionSet::~OptionSet() = default;

/// Reads the options of a struct from JSON.
template <class Struct>
Struct read_options(const Json& object, const std::string& place) {
  Struct result;
  OptionSet set;
  result.declare(set);
  set.read(object, place);
  return result;
}

}  // namespace evbench
