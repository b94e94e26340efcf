#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "core/plugin/exchange.hpp"
#include "core/plugin/source.hpp"

namespace evbench {

/// What a front-end gets in addition to its options.
struct FrontEndContext {
  const SensorData& source;  ///< outlives the front-end
  std::uint64_t seed = 0;
  std::string folder;              ///< base of relative paths in options
  std::string place = "frontend";  ///< place of the options, for messages: "config.json: frontend"
};

/// A front-end: computes track observations from a source. Each run owns one front-end. Those that read events derive
/// from EventFrontEnd (core/events/event_front_end.hpp), which reads them, batches and reports.
class FrontEnd {
 public:
  virtual ~FrontEnd() = default;

  /// Limit of one exchange.
  struct Horizon {
    double t = 0.0;                ///< [s] not beyond this time
    std::size_t observations = 0;  ///< not beyond the time of this many observations; 0: no limit
  };

  /// Replaces `batch` by the observations (raw pixels) and track ends since the last call, up to the horizon.
  /// batch.until is the horizon's time, or the time of the observation with which its number is reached (all
  /// observations of that time belong to the batch). A front-end with delayed observations sets batch.seen ≤ horizon.t
  /// to the time up to which it has processed the data, and may end the batch arbitrarily earlier; at the end of the
  /// time range it releases everything. Returns false when nothing more will follow; the run then continues without
  /// observations to the end of the time range or of the data.
  virtual bool advance(const Horizon& horizon, TrackBatch& batch) = 0;

  /// [s] End of the source's data if they end before the time range does: the run ends there. None: the data have not
  /// ended early.
  virtual std::optional<double> data_end() const { return std::nullopt; }

  /// The parts of the feedback that it uses.
  virtual FeedbackNeeds needs() const { return {}; }

  /// Receives the feedback of the back-end, in raw pixels. Called between two calls of advance(), in the order of
  /// feedback.t, once the run's latency has passed in data time.
  virtual void receive(const Feedback& /*feedback*/) {}

  /// [s] Total time it has waited for the source's events to be read, decoded or simulated: not counted as its own
  /// work.
  virtual double waited() const { return 0.0; }

  /// Remarks on the tracks for the run's log: counts, anomalies, omissions.
  virtual std::vector<std::string> remarks() const { return {}; }
};

}  // namespace evbench
