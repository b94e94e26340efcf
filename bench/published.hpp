#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "bench/published_benchmark.hpp"
#include "eval/run_record.hpp"
#include "eval/table.hpp"

namespace evbench {

/// A number of a paper. `metric`: its key, as in tables.
struct PublishedValue {
  std::string metric;
  double own;
  std::optional<double> base;  ///< of the back-end that the row compares with
};

/// Published numbers of one back-end. Errors in metres depend on the recording: on other data only their ratio to those
/// of another back-end can be compared.
struct PublishedRow {
  std::string label;  ///< of the run in our config
  std::string over;   ///< of the run that it is compared with; empty: the values themselves are compared
  std::vector<PublishedValue> values;
};

/// Published numbers for one of our experiments.
struct PublishedResult {
  std::string config;     ///< the experiment's name
  std::string what;       ///< place in the paper
  std::string protocol;   ///< of the paper's numbers
  std::string not_equal;  ///< why our numbers can't be equal; empty: they can
  std::vector<PublishedRow> rows;
};

/// configs/paper/published.json.
struct Published {
  std::string paper;
  std::optional<PublishedBenchmark> benchmark;
  std::vector<PublishedResult> results;
};

/// The folder with the paper's configs and published.json: `asked` or, if empty, configs/paper in the working folder,
/// else the installed one. Throws InputError if there is none.
std::string find_paper_configs(const std::string& asked);

/// Throws InputError with the place for a file that can't be read or has another structure.
Published read_published(const std::string& path);

/// Compares runs with the published numbers, a row per experiment, claim and metric: the ratio of two back-ends, and
/// whether it is on the same side of 1 as the paper's, or a single number. Notes give both protocols, why numbers can't
/// be equal, and the experiments without published numbers. A missing run or number is shown as "-".
std::string published_table(const Published& published, std::span<const RunRecord> runs, TableFormat format,
                            const TableLayout& layout = {});

}  // namespace evbench
