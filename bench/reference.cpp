#include "bench/reference.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "core/support/error.hpp"
#include "eval/run_numbers.hpp"

namespace evbench {
namespace {

/// The next record of a CSV file (RFC 4180); empty at its end.
std::vector<std::string> next_record(std::istream& file) {
  std::vector<std::string> cells;
  bool quoted = false, any = false;
  for (std::string cell;;) {
    const int c = file.get();
    if (c == EOF || (c == '\n' && !quoted)) {
      if (any) cells.push_back(cell);
      return cells;
    }
    any = true;
    if (c == '"') {
      if (quoted && file.peek() == '"') {
        cell.push_back(static_cast<char>(file.get()));
      } else {
        quoted = !quoted;
      }
    } else if (c == ',' && !quoted) {
      cells.push_back(std::exchange(cell, ""));
    } else if (c != '\r') {
      cell.push_back(static_cast<char>(c));
    }
  }
}

constexpr const char* kMetrics[] = {"ate.trans_m.rmse", "ate.rot_deg.rmse", "rpe.trans_m.rmse",
                                    "rpe.rot_deg.rmse", "velocity.rve.auc", "coverage"};

std::optional<double> number_at(const std::vector<std::string>& record,
                                const std::map<std::string, std::size_t>& columns, const char* name) {
  const auto found = columns.find(name);
  if (found == columns.end() || found->second >= record.size() || record[found->second].empty()) return std::nullopt;
  return std::strtod(record[found->second].c_str(), nullptr);
}

/// A run's name among those of its experiment: label, values of a sweep's axes, seed.
std::string name_of(std::string label, RunAxes axes, const std::string& seed) {
  std::ranges::sort(axes);
  for (const auto& [axis, value] : axes) {
    if (axis != "seed" && value != label) label += fmt::format(", {} {}", axis, value);
  }
  return seed.empty() ? label : fmt::format("{}, seed {}", label, seed);
}

}  // namespace

std::string compare_with_reference(std::span<const RunRecord> runs, const std::string& csv) {
  std::ifstream file(csv, std::ios::binary);
  std::map<std::string, std::size_t> columns;
  for (const std::string& header : next_record(file)) columns.emplace(header, columns.size());
  if (!columns.contains("label") || !columns.contains("seed")) {
    throw InputError(fmt::format("{}: has no columns label and seed; expected a table of runs in CSV", csv));
  }
  std::set<std::string> axes;  // of the runs that are columns; not every run of a sweep has all
  for (const RunRecord& run : runs) {
    for (const auto& [axis, value] : run.axes) {
      if (columns.contains(axis)) axes.insert(axis);
    }
  }
  std::map<std::string, std::vector<std::string>> records;
  for (auto record = next_record(file); !record.empty(); record = next_record(file)) {
    if (record.size() != columns.size()) {
      throw InputError(fmt::format("{}: a line has {} cells, expected {}", csv, record.size(), columns.size()));
    }
    RunAxes place;
    for (const std::string& axis : axes) {
      if (const std::string& value = record[columns[axis]]; !value.empty()) place.emplace_back(axis, value);
    }
    records[name_of(record[columns["label"]], std::move(place), record[columns["seed"]])] = record;
  }
  std::size_t known = 0;
  struct Worst {
    double difference = 0.0;
    std::string run;
  };
  std::map<std::string, Worst> worst;
  for (const RunRecord& run : runs) {
    const std::string name = name_of(run.label, run.axes, run.seed ? fmt::format("{}", *run.seed) : "");
    const auto found = records.find(name);
    if (found == records.end()) continue;
    ++known;
    const RunNumbers numbers(run, false);
    for (const char* metric : kMetrics) {
      const std::optional<double> before = number_at(found->second, columns, metric), now = numbers.at(metric);
      if (!before || !now || *before == 0.0) continue;
      const double difference = std::abs(*now / *before - 1.0);
      Worst& entry = worst[metric];
      if (entry.run.empty() || difference > entry.difference) entry = {difference, name};
    }
  }
  std::string text = fmt::format("{} of {} runs are in {}.", known, runs.size(), csv);
  for (const char* metric : kMetrics) {
    if (const auto found = worst.find(metric); found != worst.end()) {
      text += fmt::format(" {}: within {:.2g} %{}.", metric_of(metric).header, 100.0 * found->second.difference,
                          found->second.difference > 0.0 ? fmt::format(" ({})", found->second.run) : "");
    }
  }
  return text;
}

}  // namespace evbench
