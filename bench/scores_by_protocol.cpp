#include "bench/scores_by_protocol.hpp"

#include <algorithm>
#include <exception>
#include <map>
#include <utility>
#include <vector>

#include "bench/run_folder.hpp"
#include "core/support/error.hpp"
#include "core/support/index.hpp"
#include "core/support/parallel.hpp"
#include "eval/protocols.hpp"
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

Json score_within(const TimeRange& range, const RunRecord& run, bool causal, const std::string& protocol) {
  if (own_scores(run, causal).is_null()) return nullptr;
  try {
    ScoreOptions options = protocol_of(run, protocol);
    const bool limited = options.time_range.size() == 2;
    const TimeRange asked = limited ? TimeRange{options.time_range[0], options.time_range[1]} : TimeRange{};
    const TimeRange time = both(asked, range);
    options.time_range = {time.from, time.to};
    return scores_of(run.folder, causal, options, run);
  } catch (const InputError&) {  // too few poses, or missing files: the run's own scores remain
    return nullptr;
  }
}

/// Rethrows the first error, by index.
template <class Do>
void for_each_in_parallel(std::size_t count, const Do& act) {
  std::vector<std::exception_ptr> errors(count);
  parallel_for(0, static_cast<int>(count), [&](int i) {
    try {
      act(index(i));
    } catch (...) {
      errors[index(i)] = std::current_exception();
    }
  });
  for (const std::exception_ptr& error : errors) {
    if (error) std::rethrow_exception(error);
  }
}

}  // namespace

ScoreOptions protocol_of(const RunRecord& run, const std::string& protocol) {
  const ScoreOptions own = protocol_of_run(run.folder);
  return protocol.empty() ? own : options_by_protocol(protocol, own);
}

void score_by_protocol(std::span<RunRecord> runs, const std::string& protocol) {
  options_by_protocol(protocol);  // an unknown name is no fault of the runs
  for_each_in_parallel(runs.size(), [&](std::size_t i) {
    RunRecord& run = runs[i];
    if (!run.done) return;
    try {
      score_run(run.folder, protocol_of(run, protocol), run);
    } catch (const InputError& error) {
      run.final_scores = run.causal_scores = nullptr;
      run.final_unscored = run.causal_unscored = error.what();
    }
  });
}

void score_common_time(std::span<RunRecord> runs, bool causal, const std::string& protocol) {
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
  for_each_in_parallel(work.size(), [&](std::size_t i) {
    auto& [run, common] = work[i];
    run->common_scores = score_within(common, *run, causal, protocol);
  });
}

}  // namespace evbench
