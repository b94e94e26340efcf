#pragma once

#include <string>
#include <vector>

namespace evbench {

/// How a run went. Worse is larger.
enum class RunState {
  ok,        ///< an estimate for the whole time
  degraded,  ///< as ok, but for some spans the data did not suffice: a motion model carried the estimate, or it was
             ///< lost and went on in the same world afterwards
  lost,      ///< the estimate ended before the data did, or is in segments; what there was is kept
  failed,    ///< no estimate
};

std::string to_string(RunState state);

/// A span of time with too little data, and why.
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
