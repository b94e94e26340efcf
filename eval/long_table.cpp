#include <fmt/format.h>

#include "core/support/index.hpp"
#include "eval/table_parts.hpp"

namespace evbench {

std::string long_table(const TableRuns& runs, const TableOptions& options) {
  std::vector<std::string> header;
  for (const RunColumn& column : runs.columns) header.push_back(column.name);
  for (const char* name : {"key", "folder", "status", "reason", "trajectory", "protocol", "metric", "value"}) {
    header.emplace_back(name);
  }
  std::string text = csv_line(header);
  for (std::size_t i = 0; i < runs.runs.size(); ++i) {
    const RunRecord& run = runs.runs[i].run();
    std::vector<std::string> names;
    for (const RunColumn& column : runs.columns) names.push_back(column.values[i]);
    const int protocol = runs.protocols.of_run[i];
    for (const std::string& name :
         {run.key, run.folder, status_word(run), status_reason(run), std::string(options.causal ? "causal" : "final"),
          protocol < 0 ? std::string() : runs.protocols.texts[index(protocol)]}) {
      names.push_back(name);
    }
    std::string start = csv_line(names);
    start.back() = ',';  // instead of the line's end
    for (const Metric& metric : runs.metrics) {
      const std::optional<double> value = runs.runs[i].at(metric.key);
      fmt::format_to(std::back_inserter(text), "{}{},{}\n", start, metric.key, value ? fmt::format("{}", *value) : "");
    }
  }
  return text;
}

}  // namespace evbench
