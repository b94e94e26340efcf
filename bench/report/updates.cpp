#include "bench/report/updates.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <sstream>

#include "bench/report/column.hpp"
#include "core/support/error.hpp"

namespace evbench::report {
namespace {

/// The numbers of a CSV file by the name of their column; NaN: an empty cell.
std::vector<std::pair<std::string, std::vector<double>>> read_csv(const std::string& path) {
  std::vector<std::pair<std::string, std::vector<double>>> columns;
  std::ifstream file(path);
  std::string line, cell;
  if (!std::getline(file, line)) return columns;
  for (std::istringstream cells(line); std::getline(cells, cell, ',');) columns.push_back({cell, {}});
  while (std::getline(file, line)) {
    std::istringstream cells(line);
    for (auto& [name, values] : columns) {
      cell.clear();
      std::getline(cells, cell, ',');
      values.push_back(cell.empty() ? kMissing : std::strtod(cell.c_str(), nullptr));
    }
  }
  return columns;
}

/// Of equal parts of the updates the slowest one of each.
std::vector<std::size_t> slowest(const std::vector<double>& ms, std::size_t most) {
  std::vector<std::size_t> indices;
  const std::size_t parts = std::min(ms.size(), most);
  for (std::size_t part = 0; part < parts; ++part) {
    const auto first = ms.begin() + static_cast<std::ptrdiff_t>(part * ms.size() / parts);
    const auto last = ms.begin() + static_cast<std::ptrdiff_t>((part + 1) * ms.size() / parts);
    indices.push_back(static_cast<std::size_t>(std::max_element(first, last) - ms.begin()));
  }
  return indices;
}

std::string unit_of(const std::string& parameter) {
  if (parameter.find("qc_rotation") != std::string::npos) return "rad²/s³";
  if (parameter.find("qc_translation") != std::string::npos) return "units²/s³";
  return "";
}

}  // namespace

void add_updates(const RunRecord& run, const Budget& budget, Json& json) {
  json["updates"] = nullptr;
  json["control_times"] = nullptr;
  std::map<std::string, std::vector<double>> columns;
  for (auto& [name, values] : read_csv(run.folder + "/timing.csv")) columns[name] = std::move(values);
  const std::size_t count = columns["t_s"].size();
  for (const char* name : {"update_ms", "states", "landmarks"}) {
    if (columns[name].size() != count)
      throw InputError(fmt::format("{}/timing.csv: has no {} a line", run.folder, name));
  }
  if (count == 0) return;
  const std::vector<std::size_t> kept = slowest(columns["update_ms"], budget.updates());
  json["updates"] = {{"total", columns["t_s"].size()},
                     {"t", times(chosen(columns["t_s"], kept))},
                     {"ms", single(chosen(columns["update_ms"], kept))},
                     {"states", coarse(chosen(columns["states"], kept))},
                     {"landmarks", coarse(chosen(columns["landmarks"], kept))}};
  std::vector<double> states;
  for (const double t : columns["t_s"]) {
    if (states.empty() || t > states.back()) states.push_back(t);
  }
  json["control_times"] = times(chosen(states, thinned(states.size(), budget.updates())));
}

Json parameters_json(const RunRecord& run, const Budget& budget) {
  const auto columns = read_csv(run.folder + "/estimated_parameters.csv");
  if (columns.size() < 2 || columns.front().second.empty()) return nullptr;
  const std::vector<std::size_t> kept = thinned(columns.front().second.size(), budget.parameters());
  Json json = {{"t", times(chosen(columns.front().second, kept))}, {"columns", Json::array()}};
  for (std::size_t i = 1; i < columns.size(); ++i) {
    json["columns"].push_back({{"name", columns[i].first},
                               {"unit", unit_of(columns[i].first)},
                               {"values", coarse(chosen(columns[i].second, kept))}});
  }
  return json;
}

}  // namespace evbench::report
