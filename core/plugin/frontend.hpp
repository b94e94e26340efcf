#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "core/plugin/exchange.hpp"
#include "core/plugin/source.hpp"

namespace evbench {

/// What makes a front-end, besides its options.
struct FrontEndContext {
  const Source& source;  ///< outlives the front-end
  std::uint64_t seed = 0;
  std::string folder;              ///< what relative paths in options refer to
  std::string place = "frontend";  ///< where the options stand, for messages: "config.json: frontend"
};

/// A front-end: makes track observations from a source. One run owns one front-end.
class FrontEnd {
 public:
  virtual ~FrontEnd() = default;

  /// How far one exchange goes.
  struct Horizon {
    double t = 0.0;                ///< [s] no farther than this time
    std::size_t observations = 0;  ///< not beyond the time of this many observations; 0: no matter how many
  };

  /// Replaces `batch` by what happened since the last call, raw pixels, up to the horizon: batch.until is the horizon's
  /// time, or the time of the observation with which its number was reached (others of that same time belong to the
  /// batch). One whose observations come late says how far it has looked (batch.seen ≤ horizon.t) and ends the batch
  /// earlier: it may do so by as much as it likes, but at the end of the time range nothing is left. Returns false when
  /// nothing more will come at any time; the run then goes on without observations, to the end of the time range or of
  /// the data.
  virtual bool advance(const Horizon& horizon, TrackBatch& batch) = 0;

  /// [s] Where the source's data have turned out to end before its time range does: time goes no farther, as nothing
  /// is known of it. None: they have not.
  virtual std::optional<double> data_end() const { return std::nullopt; }

  /// What of the feedback is made use of.
  virtual FeedbackNeeds needs() const { return {}; }

  /// What the back-end knows, raw pixels: called between two calls of advance(), in the order of feedback.t, each once
  /// the run's latency has passed in data time.
  virtual void receive(const Feedback& /*feedback*/) {}

  /// [s] It has waited for its source's events so far, which are read, decoded or simulated meanwhile: no work of its
  /// own.
  virtual double waited() const { return 0.0; }

  /// What a user should know of the tracks: counts, oddities, what was left out. For the run's log.
  virtual std::vector<std::string> remarks() const { return {}; }
};

}  // namespace evbench
