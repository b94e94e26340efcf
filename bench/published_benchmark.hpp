#pragma once

#include <string>
#include <vector>

#include "eval/record_reader.hpp"
#include "eval/run_record.hpp"
#include "eval/table.hpp"

namespace evbench {

/// Published numbers of other systems on the sequences of a dataset: the key "benchmark" of
/// configs/paper/published.json.
struct PublishedBenchmark {
  struct Row {
    std::string system, inputs, protocol, paper;  ///< protocol: a name of eval/protocols.hpp
    std::vector<double> values;                   ///< a number per sequence
  };
  std::string dataset, metric;
  std::vector<std::string> sequences;
  std::vector<Row> rows;
};

/// Throws InputError with the place for another structure, or an unknown protocol.
PublishedBenchmark read_published_benchmark(const RecordReader& json);

/// The sequence that a run is of, by the end of its source's dataset or folder; empty if it is none of the benchmark's.
std::string sequence_in(const PublishedBenchmark& benchmark, const RunRecord& run);

/// Puts the runs of a sequence beside the published numbers of it, each protocol apart: our runs are scored by it in
/// memory, those of one experiment and label as their median. Runs of other sequences are left out. Throws InputError,
/// with the nearest name, for an unknown sequence, and where no run is left.
std::string published_sequence_table(const PublishedBenchmark& benchmark, const std::string& sequence,
                                     std::vector<RunRecord> runs, TableFormat format, const TableLayout& layout = {});

}  // namespace evbench
