#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "eval/run_record.hpp"
#include "eval/table.hpp"

namespace evbench {

/// A number of a paper, by its metric, as in tables.
struct PublishedValue {
  std::string metric;
  double own;
  std::optional<double> base;  ///< of what the row compares with
};

/// What a paper says of one back-end. Errors in metres are of its recording: only how they compare with those of
/// another back-end can be found again elsewhere.
struct PublishedRow {
  std::string label;  ///< of the run in our config
  std::string over;   ///< of the run that it is compared with; empty: the values themselves are
  std::vector<PublishedValue> values;
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

/// What these runs say of what the paper claims, a row an experiment, claim and metric: a ratio of two back-ends, and
/// whether it is on the same side of 1 as the paper's, or a number itself; below stand both protocols, and why numbers
/// can't be equal. What the paper tells of a run that is not there, or has no such number, is shown with "-".
/// Experiments that the paper says nothing of are named.
std::string published_table(const Published& published, std::span<const RunRecord> runs, TableFormat format,
                            const TableLayout& layout = {});

}  // namespace evbench
