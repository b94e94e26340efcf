#pragma once

#include <span>
#include <string>
#include <utility>
#include <vector>

#include "eval/run_record.hpp"
#include "eval/table.hpp"

namespace evbench {

/// What a paper says of one back-end.
struct PublishedRow {
  std::string label;                                   ///< of the run in our config
  std::vector<std::pair<std::string, double>> values;  ///< by metric, as in tables
};

/// What a paper says of an experiment of ours.
struct PublishedResult {
  std::string config;     ///< the experiment's name
  std::string what;       ///< where in the paper
  std::string protocol;   ///< how the paper's numbers came about
  std::string not_equal;  ///< why ours can't be the same; empty: they can
  std::vector<PublishedRow> rows;
};

/// configs/paper/published.json.
struct Published {
  std::string paper;
  std::vector<PublishedResult> results;
};

/// Throws InputError with the place for a file that can't be read or is not of that structure.
Published read_published(const std::string& path);

/// Our numbers of these runs beside the paper's, a row an experiment, back-end and metric; below stand both protocols,
/// and why numbers can't be equal. What the paper tells of a run that is not there, or has no such number, is shown
/// with "-". Experiments that the paper says nothing of are named.
std::string published_table(const Published& published, std::span<const RunRecord> runs, TableFormat format);

}  // namespace evbench
