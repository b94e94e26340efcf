#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "eval/run_record.hpp"

namespace evbench {

/// Something that tells runs apart, and what each run says of it.
struct RunColumn {
  std::string name;
  std::vector<std::string> values;  ///< one a run; "" where it has none

  /// Do runs differ in it?
  bool varies() const;
};

/// All that tells runs apart, in this order: "experiment"; "label"; the settings in which runs of one experiment and
/// label differ, named as in a config ("backend.batch_duration"), or, of runs of a sweep, its axes; "seed".
std::vector<RunColumn> run_columns(std::span<const RunRecord> runs);

/// The column of that name; throws InputError, with the nearest name, where there is none.
const RunColumn& find_column(const std::vector<RunColumn>& columns, std::string_view name);

/// Runs that these columns do not tell apart, by their indices: in the order of their first, and each in its own.
std::vector<std::vector<std::size_t>> equal_runs(const std::vector<const RunColumn*>& columns, std::size_t runs);

/// What a run saw, as text: all settings of its source, and the seed. Runs of equal texts saw the same sequence.
std::string sequence_of(const RunRecord& run);

/// What the observations of a run came from, as text: its sequence, and all settings of the front-end. Runs of equal
/// texts can be compared pair by pair.
std::string data_of(const RunRecord& run);

}  // namespace evbench
