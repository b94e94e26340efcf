#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "eval/run_record.hpp"

namespace evbench {

/// A column that distinguishes runs, with its value for each run.
struct RunColumn {
  std::string name;
  std::vector<std::string> values;  ///< one per run; "" if it has none

  /// Whether runs differ in it.
  bool varies() const;
};

/// The columns that distinguish runs, in this order: "experiment"; "label"; the settings in which runs of one
/// experiment and label differ, named as in a config ("backend.batch_duration"), or the axes for runs of a sweep;
/// "seed".
std::vector<RunColumn> run_columns(std::span<const RunRecord> runs);

/// The column of that name. Throws InputError, with the nearest name, if there is none.
const RunColumn& find_column(const std::vector<RunColumn>& columns, std::string_view name);

/// Groups of runs, by index, that have equal values in these columns: in the order of their first run.
std::vector<std::vector<std::size_t>> equal_runs(const std::vector<const RunColumn*>& columns, std::size_t runs);

/// The sequence of a run as text: all settings of its source, and the seed. Runs with equal texts have the same
/// sequence.
std::string sequence_of(const RunRecord& run);

/// The origin of a run's observations as text: its sequence, and all settings of the front-end. Runs with equal texts
/// can be compared pair by pair.
std::string data_of(const RunRecord& run);

}  // namespace evbench
