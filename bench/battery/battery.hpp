#pragma once

#include <string>
#include <vector>

#include "bench/battery/check.hpp"
#include "core/plugin/registry.hpp"
#include "core/support/json.hpp"

namespace evbench::battery {

// The conformance battery: what every plugin must do, whatever its options. `options` are the plugin's, complete or
// not; InputError for a name or options that are wrong. The checks refer to `plugins`, which must outlive them.

/// A back-end is fed simulated tracks, good and bad ones, through the pipeline.
std::vector<Check> backend_checks(const Plugins& plugins, const std::string& name,
                                  const Json& options = Json::object());

/// A front-end is asked for the tracks of a source, which must outlive the checks; `folder`: what relative paths in its
/// options refer to.
std::vector<Check> frontend_checks(const Plugins& plugins, const std::string& name, const Json& options,
                                   const Source& source, const std::string& folder = ".");

/// A source is asked for all that it has.
std::vector<Check> source_checks(const Plugins& plugins, const std::string& name, const Json& options,
                                 const std::string& folder = ".");

/// What front-ends are tried on where nothing else is given: 3 s of simulated tracks before random points.
const Source& usual_source();

}  // namespace evbench::battery
