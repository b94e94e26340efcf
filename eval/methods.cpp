#include "eval/methods.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include "core/support/error.hpp"
#include "core/support/nearest.hpp"

namespace evbench {
namespace {

/// The columns in which runs of one label on the same data differ, and the label.
std::vector<const RunColumn*> method_columns(const std::vector<RunColumn>& columns,
                                             const std::vector<std::size_t>& data, const std::string& without,
                                             const std::string& apart) {
  const RunColumn& labels = find_column(columns, "label");
  std::map<std::pair<std::size_t, std::string>, std::size_t> firsts;
  std::set<const RunColumn*> differing;
  for (std::size_t i = 0; i < data.size(); ++i) {
    const std::size_t first = firsts.try_emplace({data[i], labels.values[i]}, i).first->second;
    for (const RunColumn& column : columns) {
      if (column.values[i] != column.values[first]) differing.insert(&column);
    }
  }
  for (const RunColumn& column : columns) {
    if (column.name == apart && column.varies()) differing.insert(&column);
  }
  std::vector<const RunColumn*> result = {&labels};
  for (const RunColumn& column : columns) {
    const bool names = &column != &labels && column.name != without && differing.contains(&column);
    if (names) result.push_back(&column);
  }
  return result;
}

std::string method_name(const std::vector<const RunColumn*>& columns, std::size_t run) {
  std::string name = columns.front()->values[run];
  for (std::size_t c = 1; c < columns.size(); ++c) {
    const std::string& value = columns[c]->values[run];
    if (!value.empty()) name += fmt::format(", {} {}", columns[c]->name, value);
  }
  return name;
}

}  // namespace

std::vector<Method> methods_of(const std::vector<RunNumbers>& runs, const std::vector<RunColumn>& columns,
                               const std::vector<std::size_t>& data, const std::string& without,
                               const std::string& apart) {
  const std::vector<const RunColumn*> naming = method_columns(columns, data, without, apart);
  const auto left_out = std::ranges::find(columns, without, &RunColumn::name);
  const auto place = [&](std::size_t i) {
    return fmt::format("{} {}", data[i], left_out == columns.end() ? "" : left_out->values[i]);
  };
  std::vector<Method> methods;
  for (std::vector<std::size_t>& group : equal_runs(naming, runs.size())) {
    std::erase_if(group, [&](std::size_t i) { return !runs[i].run().done; });
    if (group.empty()) continue;
    keep_one_of_each(group, runs, place);
    methods.push_back({method_name(naming, group.front()), std::move(group)});
  }
  return methods;
}

const Method& find_method(const std::vector<Method>& methods, const std::string& name) {
  const auto found = std::ranges::find(methods, name, &Method::name);
  if (found != methods.end()) return *found;
  std::vector<std::string> names;
  for (const Method& method : methods) names.push_back(method.name);
  throw InputError(fmt::format("there is no method \"{}\"{}", name, suggestion(name, names)));
}

}  // namespace evbench
