#pragma once

#include <string>
#include <vector>

#include "core/support/json_fwd.hpp"

// Names of options, metrics and files before version 1.0. They are accepted for one version; then this file is removed.
namespace evbench {

/// Renames a config's keys to their present names. Returns a remark for each. A key whose present name also exists is
/// not renamed: reading the config then gives an error.
std::vector<std::string> rename_old_keys(Json& config);

/// Renames the keys of metrics.json to their present names.
void rename_old_metrics(Json& metrics);

/// The present name of a metric.
std::string present_metric(const std::string& name);

/// The path of a file in a run's folder: FOLDER/NAME, or its older name if only that exists.
std::string file_of_run(const std::string& folder, const std::string& name);

}  // namespace evbench
