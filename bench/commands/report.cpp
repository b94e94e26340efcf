#include "bench/commands/report.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>

#include "bench/commands/commands.hpp"
#include "bench/commands/protocol_option.hpp"
#include "bench/commands/run_outputs.hpp"
#include "bench/commands/run_selection.hpp"
#include "bench/report/report.hpp"
#include "bench/scores_by_protocol.hpp"
#include "core/io/atomic_file.hpp"
#include "core/io/file_content.hpp"
#include "eval/find_runs.hpp"
#include "eval/table.hpp"

namespace evbench {
namespace {

struct ReportArguments {
  RunSelection runs;
  std::string out, protocol;
  bool force = false;
};

constexpr const char* kName = "report.html";

/// Whether an existing file is a report, which may be made anew.
bool is_report(const std::string& file) {
  return file_content(file).value_or("").find(R"(id="data">{"format":"evbench.report",)") != std::string::npos;
}

std::string file_of(const ReportArguments& arguments) {
  if (!arguments.out.empty()) return arguments.out;
  const bool is_one = arguments.runs.folders.size() == 1 && std::filesystem::is_directory(arguments.runs.folders[0]);
  return is_one ? (std::filesystem::path(arguments.runs.folders[0]) / kName).string() : kName;
}

void write_report(std::vector<RunRecord> runs, const std::string& protocol, const std::string& command,
                  const std::string& file) {
  if (shows_common_time({}, runs.size())) score_common_time(runs, false, protocol);
  write_file(file, report::page(report::payload(runs, protocol, command)));
}

void execute(const ReportArguments& arguments) {
  const std::string file = file_of(arguments);
  check_outputs({file}, {}, arguments.force || is_report(file));
  std::string command = "evbench report";
  for (const std::string& folder : arguments.runs.folders) command += " " + folder;
  use_runs(arguments.runs, [&](std::vector<RunRecord>& runs) {
    if (!arguments.protocol.empty()) score_by_protocol(runs, arguments.protocol);
    write_report(std::move(runs), arguments.protocol, command, file);
    fmt::print("written: {}\n", file);
  });
}

}  // namespace

void check_report_of(const std::string& folder) {
  const std::string file = (std::filesystem::path(folder) / kName).string();
  check_outputs({file}, {}, is_report(file));
}

void report_folder(const std::string& folder, const std::string& command, bool quiet) {
  const std::string file = (std::filesystem::path(folder) / kName).string();
  std::vector<std::string> unreadable;
  write_report(find_runs(std::vector{folder}, &unreadable), "", command, file);
  for (const std::string& reason : unreadable) fmt::print(stderr, "remark: not in the report: {}\n", reason);
  if (!quiet) fmt::print("written: {}\n", file);
}

void add_report(CLI::App& app) {
  auto arguments = std::make_shared<ReportArguments>();
  CLI::App* command =
      app.add_subcommand("report", "Write runs as one page for a browser: tables, trajectories, figures");
  add_run_selection(*command, arguments->runs);
  command->add_option("--out", arguments->out, "The page; by default report.html in DIR, or here for several")
      ->type_name("FILE");
  add_protocol_name(*command, arguments->protocol,
                    "Score by a published protocol (evbench list protocols) for this page; the runs stay as they are");
  command->add_flag("--force", arguments->force, "Replace a file that exists; a report is replaced without it");
  command->footer(
      "The page is one file that needs no network and no other file: send it, or open it from the disk.\n"
      "Curves of many runs are thinned, so that a page of 100 runs of 60 s stays below 5 MB.");
  command->callback([arguments] { execute(*arguments); });
}

}  // namespace evbench
