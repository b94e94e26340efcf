#pragma once

#include <optional>
#include <string>
#include <vector>

#include "bench/pipeline/pace.hpp"
#include "core/plugin/exchange.hpp"

namespace evbench {

/// Times and log of the front-end half of a run.
struct FrontFacts {
  double source_s = 0.0;         ///< [s] waiting for events
  double frontend_s = 0.0;       ///< [s] processing in the front-end
  std::vector<Work> work;        ///< the same, exchange by exchange
  double data_s = 0.0;           ///< [s] from the first to the last observation
  std::vector<std::string> log;  ///< remarks of source and front-end, for the run's log
};

/// The front-end half of a run as the back-end half uses it: a live front-end (FrontEndRunner) or a recording
/// (RecordedBatches).
class BatchStream {
 public:
  virtual ~BatchStream() = default;

  /// The next batch that has new data or a later `until`, raw pixels, `seen` set; none at the end of the time range.
  virtual std::optional<TrackBatch> next() = 0;

  /// Complete once next() has returned none.
  virtual FrontFacts facts() const = 0;

  /// [s] wall time spent in calls of this object so far.
  virtual double spent() const = 0;
};

}  // namespace evbench
