#pragma once

#include <optional>
#include <string>
#include <vector>

#include "bench/pipeline/pace.hpp"
#include "core/plugin/exchange.hpp"

namespace evbench {

/// What is known of a front-end's side of a run at its end.
struct FrontFacts {
  double source_s = 0.0;         ///< [s] its waiting for events
  double frontend_s = 0.0;       ///< [s] its own work
  std::vector<Work> work;        ///< of that, for each exchange
  double data_s = 0.0;           ///< [s] from the first to the last observation that it gave
  std::vector<std::string> log;  ///< what source and front-end remarked, for the run's log
};

/// The front-end's side of a run, as its back-end's side sees it.
class BatchStream {
 public:
  virtual ~BatchStream() = default;

  /// The next batch that tells of new time, raw pixels, `seen` set; none at the end of the time range.
  virtual std::optional<TrackBatch> next() = 0;

  /// Once there is no further batch.
  virtual FrontFacts facts() const = 0;

  /// [s] that its calls have taken so far.
  virtual double spent() const = 0;
};

}  // namespace evbench
