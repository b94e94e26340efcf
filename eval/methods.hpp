#pragma once

#include <string>
#include <vector>

#include "eval/run_columns.hpp"
#include "eval/run_numbers.hpp"

namespace evbench {

/// What is compared with others: the runs of one back-end with one set of options, by their indices.
struct Method {
  std::string name;
  std::vector<std::size_t> runs;
};

/// The methods among runs: what runs of the same data (data_of() in run_columns.hpp) differ in. A name is the label
/// and, where runs of one label differ on the same data, the columns in which they do: "bundle adjustment,
/// backend.batch_duration 0.1". A column of the name `without` is none of these, one of the name `apart` is, where it
/// varies, whatever the data. Runs that were not run are left out.
/// Each method has one run for each data (and value of `without`); throws InputError where two are not the same job.
std::vector<Method> methods_of(const std::vector<RunNumbers>& runs, const std::vector<RunColumn>& columns,
                               const std::string& without = "", const std::string& apart = "");

/// The method of that name; throws InputError, with the nearest name, where there is none.
const Method& find_method(const std::vector<Method>& methods, const std::string& name);

}  // namespace evbench
