#include "bench/sweep/sweep_file.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <map>
#include <set>
#include <span>
#include <utility>

#include "bench/experiment.hpp"
#include "bench/plugins.hpp"
#include "core/io/path.hpp"
#include "core/plugin/library.hpp"
#include "core/support/error.hpp"
#include "core/support/json.hpp"

namespace evbench {
namespace fs = std::filesystem;
namespace {

struct SweepOptions {
  std::string base, name, description, config;
  Json plugins = Json::array(), set = Json::object(), draw, axes = Json::array(), grids;
  RunLimits limits;

  void declare(OptionSet& options) {
    options.add("base", base, "another sweep's file that this one extends: its path from this file's folder").path();
    options.add("name", name, "its folder below --out; by default the file's name");
    options.add("description", description, "what it is for");
    options.add("config", config, "base config: its path from this file's folder").required().path();
    options.add("plugins", plugins, "libraries that plugins come from: a list of paths");
    options.add("set", set, "values that differ from the base config's: {KEY: VALUE}");
    options.add("draw", draw,
                "what is drawn at random for each run, by its seed: {NAME: {TEXT: {KEY: VALUE}}}, {KEY: "
                "{\"uniform\": [A, B]}}, ...");
    options.add("axes", axes, "what is varied: a list of axes");
    options.add("grids", grids, "several sets of axes, one after the other: a list of {\"axes\": [...]}");
    limits.declare(options);
  }
};

struct GridOptions {
  Json axes = Json::array();
  void declare(OptionSet& set) { set.add("axes", axes, "a list of axes").required(); }
};

void add_axes(const Json& axes, const std::string& place, Grid& grid) {
  if (!axes.is_array()) throw InputError(fmt::format("{}: expected a list of axes", place));
  for (std::size_t i = 0; i < axes.size(); ++i) grid.push_back(read_axis(axes[i], fmt::format("{}.{}", place, i)));
}

/// No axis may override what an earlier one has set, as runs would be shown at wrong values, nor what the command line
/// sets, "KEY=VALUE", which would be lost in silence.
void check_axes(const Sweep& sweep, const Grid& grid, std::span<const std::string> given) {
  std::set<std::string> names;
  std::map<std::string, std::string> set_by;  // key, axis
  std::vector<Axis> axes;
  for (const std::vector<Axis>& together : grid) axes.insert(axes.end(), together.begin(), together.end());
  for (const Axis& axis : axes) {
    std::set<std::string> keys;
    for (const AxisValue& value : axis.values) {
      for (std::string& key : value.keys()) keys.insert(std::move(key));
    }
    for (const std::string& key : keys) {
      for (const std::string& item : given) {
        const std::string own = item.substr(0, item.find('='));
        if (own != key && !own.starts_with(key + ".")) continue;
        throw InputError(fmt::format(
            "--set {}: the axis \"{}\" of {} sets \"{}\" afterwards, and it would be lost; expected a key that "
            "no axis sets",
            item, axis.name, sweep.place, key));
      }
      for (const auto& [earlier, by] : set_by) {
        if (earlier != key && !earlier.starts_with(key + ".")) continue;
        throw InputError(
            fmt::format("{}: the axis \"{}\" sets \"{}\", and with it \"{}\" of the axis \"{}\" before it; "
                        "expected {}",
                        sweep.place, axis.name, key, earlier, by,
                        earlier == key ? "one axis for a key" : fmt::format("\"{}\" behind it", by)));
      }
    }
    for (const std::string& key : keys) set_by.emplace(key, axis.name);
    if (names.insert(axis.name).second) continue;
    throw InputError(fmt::format("{}: two axes are called \"{}\"; give one another \"name\"", sweep.place, axis.name));
  }
}

void load_libraries(const Json& list, const std::string& place, const std::string& folder, Plugins& plugins,
                    const LibraryPolicy& policy) {
  if (!list.is_array()) throw InputError(fmt::format("{}: plugins: expected a list of paths", place));
  std::vector<std::string> paths;
  for (const Json& item : list) {
    if (!item.is_string())
      throw InputError(fmt::format("{}: plugins: expected paths, found {}", place, dump_json(item)));
    paths.push_back(resolve_path(item.get<std::string>(), folder));
  }
  load_named_plugins(plugins, paths, place + ": plugins", policy);
}

/// The sweep with all that its base has: what both have in "set" and "axes" is joined, the base's first; other keys are
/// replaced.
Json extended(const Json& json, const std::string& path) {
  if (!json.contains("base")) return json;
  if (!json["base"].is_string()) throw InputError(fmt::format("{}: base: expected the path of a sweep's file", path));
  const std::string base_path =
      resolve_path(json["base"].get<std::string>(), fs::absolute(path).parent_path().string());
  const std::string folder = fs::absolute(base_path).parent_path().string();
  Json result = read_json(base_path);
  if (!result.is_object() || result.contains("base")) {
    throw InputError(
        fmt::format("{}: base: {}: expected the file of a sweep, without a base of its own", path, base_path));
  }
  if (result.contains("config") && result["config"].is_string()) {
    result["config"] = resolve_path(result["config"].get<std::string>(), folder);
  }
  if (result.contains("plugins") && result["plugins"].is_array()) {
    for (Json& library : result["plugins"]) {
      if (library.is_string()) library = resolve_path(library.get<std::string>(), folder);
    }
  }
  result.erase("name");
  for (const auto& [key, value] : json.items()) {
    if (key == "set" && result.contains(key) && result[key].is_object() && value.is_object()) {
      for (const auto& [path_in_config, setting] : value.items()) {
        result[key].erase(path_in_config);
        result[key][path_in_config] = setting;  // behind what the base sets
      }
    } else if (key == "axes" && result.contains(key) && result[key].is_array() && value.is_array()) {
      for (const Json& axis : value) result[key].push_back(axis);
    } else {
      result[key] = value;
    }
  }
  return result;
}

Sweep read_file(const Json& own, const std::string& path, Plugins& plugins, const LibraryPolicy& policy) {
  const auto options = read_options<SweepOptions>(extended(own, path), path);
  const std::string folder = fs::absolute(path).parent_path().string();
  Sweep sweep;
  sweep.place = path;
  sweep.name = options.name.empty() ? fs::path(path).stem().string() : options.name;
  sweep.config = resolve_path(options.config, folder);
  sweep.draw = options.draw;
  sweep.limits = options.limits;
  load_libraries(options.plugins, path, folder, plugins, policy);
  if (!options.set.is_object()) throw InputError(fmt::format("{}: set: expected an object {{KEY: VALUE}}", path));
  for (const auto& [key, value] : options.set.items()) {
    sweep.overrides.push_back(key + "=" + override_text(value));
  }
  Grid common;
  add_axes(options.axes, path + ": axes", common);
  if (options.grids.is_null()) {
    sweep.grids.push_back(common);
    return sweep;
  }
  if (!options.grids.is_array() || options.grids.empty()) {
    throw InputError(fmt::format("{}: grids: expected a list of at least one {{\"axes\": [...]}}", path));
  }
  for (std::size_t i = 0; i < options.grids.size(); ++i) {
    const std::string place = fmt::format("{}: grids.{}", path, i);
    Grid grid = common;
    add_axes(read_options<GridOptions>(options.grids[i], place).axes, place + ".axes", grid);
    sweep.grids.push_back(std::move(grid));
  }
  return sweep;
}

}  // namespace

Sweep read_sweep(const std::string& path, const std::vector<std::string>& overrides,
                 const std::vector<std::string>& over, Plugins& plugins, const LibraryPolicy& policy) {
  const Json json = read_json(path);
  Sweep sweep;
  const bool is_sweep = json.is_object() && (json.contains("config") || json.contains("axes") ||
                                             json.contains("grids") || json.contains("base"));
  if (is_sweep) {
    sweep = read_file(json, path, plugins, policy);
  } else {
    sweep.place = sweep.config = path;
    sweep.grids.emplace_back();
  }
  sweep.overrides.insert(sweep.overrides.end(), overrides.begin(), overrides.end());
  try {
    load_plugins_of(plugins, sweep.config, sweep.overrides, policy);
  } catch (const InputError& error) {
    if (sweep.place == sweep.config) throw;
    throw InputError(fmt::format("{}: {}", sweep.place, error.what()));
  }
  for (const std::string& text : over) {
    for (Grid& grid : sweep.grids) grid.push_back({parse_axis(text)});
  }
  for (const Grid& grid : sweep.grids) check_axes(sweep, grid, overrides);
  return sweep;
}

std::string describe_sweep() {
  SweepOptions options;
  OptionSet set;
  options.declare(set);
  return set.describe();
}

}  // namespace evbench
