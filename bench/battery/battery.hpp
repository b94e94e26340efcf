#pragma once

#include <string>
#include <vector>

#include "bench/battery/check.hpp"
#include "core/plugin/registry.hpp"
#include "core/support/json.hpp"

namespace evbench::battery {

// The conformance battery: checks that every plugin must pass, whatever its options. `options` are the plugin's; the
// defaults are filled in. Throws InputError for a wrong name or wrong options. The checks refer to `plugins`, which
// must outlive them.

/// Runs a back-end on simulated tracks, good and bad ones, through the pipeline.
std::vector<Check> backend_checks(const Plugins& plugins, const std::string& name,
                                  const Json& options = Json::object());

/// Runs a front-end on a source, which must outlive the checks. `folder`: base of relative paths in its options.
std::vector<Check> frontend_checks(const Plugins& plugins, const std::string& name, const Json& options,
                                   const Source& source, const std::string& folder = ".");

/// Reads all data of a source.
std::vector<Check> source_checks(const Plugins& plugins, const std::string& name, const Json& options,
                                 const std::string& folder = ".");

/// The default source for checks of front-ends: 3 s of simulated tracks of random points.
const Source& usual_source();

}  // namespace evbench::battery
