#pragma once

#include <string>
#include <vector>

#include "bench/plugins.hpp"
#include "bench/sweep/axis.hpp"
#include "bench/sweep/run_limits.hpp"
#include "core/plugin/registry.hpp"

namespace evbench {

/// Axes that vary independently: their product. The first one varies slowest.
using Grid = std::vector<ZippedAxes>;

/// A base config and the axes that vary it.
struct Sweep {
  std::string place;                   ///< the file, for messages
  std::string name;                    ///< its folder below --out; empty: the config's name
  std::string config;                  ///< path of the base config
  std::vector<std::string> overrides;  ///< "KEY=VALUE", before those of the axes
  Json draw;                           ///< what is drawn at random for each run, by its seed (draw.hpp); null: nothing
  std::vector<Grid> grids;             ///< at least one; the sweep is all of them, one after the other
  RunLimits limits;
};

/// Reads the file of a sweep, or takes a config for one whose only point is the config itself, and loads the libraries
/// that either names, by the policy. A sweep's file is an object with
///
///   "base"     path of another sweep's file, whose keys this one extends ("set", "axes") or replaces
///   "config"   path of the base config, from the sweep's folder
///   "name", "description", "timeout", "memory"
///   "plugins"  list of libraries, as in a config; paths from the sweep's folder
///   "set"      {KEY: VALUE, ...} in the base config
///   "draw"     what is drawn at random for each run, by its seed (draw.hpp)
///   "axes"     list of axes (axis.hpp) that all runs have
///   "grids"    list of {"axes": [...]}: each is multiplied by "axes"; without them there is one
///
/// `overrides` and `over` (axis.hpp: parse_axis()) come from the command line and are added to what the file says.
/// Throws InputError for anything that is not as expected, with the place.
Sweep read_sweep(const std::string& path, const std::vector<std::string>& overrides,
                 const std::vector<std::string>& over, Plugins& plugins, const LibraryPolicy& policy = {});

/// The keys of a sweep's file, for people.
std::string describe_sweep();

}  // namespace evbench
