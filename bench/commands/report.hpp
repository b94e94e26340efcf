#pragma once

#include <string>
#include <vector>

#include "eval/run_record.hpp"

namespace evbench {

/// Writes the page of these runs to a file. `command`: the one that asks for it. Throws OutputError.
void write_report(std::vector<RunRecord> runs, const std::string& command, const std::string& file);

/// Writes the page of all runs below a folder to FOLDER/report.html, and prints its path unless `quiet`.
void report_folder(const std::string& folder, const std::string& command, bool quiet);

}  // namespace evbench
