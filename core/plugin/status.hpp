#pragma once

#include <string>
#include <vector>

namespace evbench {

/// Result of a run. Worse is larger.
enum class RunState {
  ok,        ///< an estimate for the whole time range
  degraded,  ///< as ok, but in some spans the data did not suffice: the motion model carried the estimate, or tracking
             ///< was lost and continued in the same world frame
  lost,      ///< the estimate ends before the data do, or consists of several segments; all segments are kept
  failed,    ///< no estimate
};

std::string to_string(RunState state);

/// A time span with too little data, and the reason.
struct DegradedSpan {
  double from = 0.0, to = 0.0;  ///< [s]
  std::string reason;
};

struct Status {
  RunState state = RunState::ok;
  std::string reason;  ///< a sentence; empty when ok
  double time = 0.0;   ///< [s], sequence time of the event that set the state; meaningless when ok
  std::vector<DegradedSpan> degraded;
};

}  // namespace evbench
