#include "bench/common_time.hpp"

#include <algorithm>
#include <exception>
#include <map>
#include <utility>
#include <vector>

#include "bench/run_folder.hpp"
#include "core/support/error.hpp"
#include "core/support/index.hpp"
#include "core/support/parallel.hpp"
#include "eval/run_columns.hpp"
#include "eval/score_run.hpp"

namespace evbench {
namespace {

const Json& own_scores(const RunRecord& run, bool causal) { return causal ? run.causal_scores : run.final_scores; }

/// From the first to the last compared pose.
std::optional<TimeRange> span_of(const Json& scores) {
  const Json span = scores.value("span_s", Json());
  if (!span.is_array() || span.size() != 2) return std::nullopt;  // scored by an older version
  return TimeRange{span[0].get<double>(), span[1].get<double>()};
}

TimeRange both(const TimeRange& a, const TimeRange& b) { return {std::max(a.from, b.from), std::min(a.to, b.to)}; }

TimeRange common_time(const std::vector<RunRecord*>& runs, bool causal) {
  TimeRange common;
  for (const RunRecord* run : runs) {
    const Json& scores = own_scores(*run, causal);
    if (scores.is_null() || !run->competes()) continue;
    if (const std::optional<TimeRange> span = span_of(scores)) common = both(common, *span);
  }
  return common;
}

Json score_within(const TimeRange& range, const RunRecord& run, bool causal) {
  if (own_scores(run, causal).is_null()) return nullptr;
  try {
    ScoreOptions options = protocol_of_run(run.folder);
    const bool limited = options.time_range.size() == 2;
    const TimeRange asked = limited ? TimeRange{options.time_range[0], options.time_range[1]} : TimeRange{};
    const TimeRange time = both(asked, range);
    options.time_range = {time.from, time.to};
    return scores_of(run.folder, causal, options, run);
  } catch (const InputError&) {  // too few poses, or missing files: the run's own scores remain
    return nullptr;
  }
}

}  // namespace

void score_common_time(std::span<RunRecord> runs, bool causal) {
  std::map<std::pair<std::string, std::string>, std::vector<RunRecord*>> sequences;
  for (RunRecord& run : runs) sequences[{run.experiment, sequence_of(run)}].push_back(&run);
  std::vector<std::pair<RunRecord*, TimeRange>> work;
  for (const auto& [name, of_one] : sequences) {
    const TimeRange common = common_time(of_one, causal);
    for (RunRecord* run : of_one) {
      run->common_scores = nullptr;
      if (common.from < common.to) work.emplace_back(run, common);
    }
  }
  std::vector<std::exception_ptr> errors(work.size());
  parallel_for(0, static_cast<int>(work.size()), [&](int i) {
    auto& [run, common] = work[index(i)];
    try {
      run->common_scores = score_within(common, *run, causal);
    } catch (...) {
      errors[index(i)] = std::current_exception();
    }
  });
  for (const std::exception_ptr& error : errors) {
    if (error) std::rethrow_exception(error);
  }
}

}  // namespace evbench
