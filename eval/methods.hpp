#pragma once

#include <string>
#include <vector>

#include "eval/run_columns.hpp"
#include "eval/run_numbers.hpp"

namespace evbench {

/// A method in a comparison: the runs of one back-end (or front-end and back-end) with one set of options, by index.
struct Method {
  std::string name;
  std::vector<std::size_t> runs;
};

/// The methods among runs on data that are numbered (number_data()). Its name is the label and, if runs of one label
/// differ on the same data, the columns in which they differ: "bundle adjustment, backend.batch_duration 0.1". The
/// column `without` is never part of a name; the column `apart` always is, if it varies. Runs that were not run are
/// left out. Each method has one run for each data (and value of `without`); throws InputError if two are not the same
/// job.
std::vector<Method> methods_of(const std::vector<RunNumbers>& runs, const std::vector<RunColumn>& columns,
                               const std::vector<std::size_t>& data, const std::string& without = "",
                               const std::string& apart = "");

/// The method of that name. Throws InputError, with the nearest name, if there is none.
const Method& find_method(const std::vector<Method>& methods, const std::string& name);

}  // namespace evbench
