#pragma once

#include <string>
#include <vector>

#include "core/support/json_fwd.hpp"

// Names of options, metrics and files before version 1.0. They are read for one version; this file then goes.
namespace evbench {

/// Gives a config's keys their present names. Returns a sentence for each that was renamed. A key whose present name is
/// there, too, stays as it is: reading the config then refuses it.
std::vector<std::string> rename_old_keys(Json& config);

/// Gives the keys of metrics.json their present names.
void rename_old_metrics(Json& metrics);

/// The present name of a metric.
std::string present_metric(const std::string& name);

/// The path of a file in a run's folder: FOLDER/NAME, or, where there is only that one, the file's older name.
std::string file_of_run(const std::string& folder, const std::string& name);

}  // namespace evbench
