#pragma once

#include <string>

namespace evbench {

/// Throws InputError if FOLDER/report.html exists and is no report. To be called before any run.
void check_report_of(const std::string& folder);

/// Writes the page of all runs below a folder to FOLDER/report.html, and prints its path unless `quiet`. Runs that
/// can't be read are named in remarks. `command`: the one that asks for it. Throws OutputError.
void report_folder(const std::string& folder, const std::string& command, bool quiet);

}  // namespace evbench
