#pragma once

#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "bench/recordings/rate_plot.hpp"
#include "core/events/event_stream.hpp"
#include "core/support/json.hpp"

namespace evbench {

/// The content of `evbench info` on a recording, after reading all of it.
struct RecordingSummary {
  std::vector<std::string> files;  ///< that hold the events
  StreamInfo info;
  std::int64_t events = 0, on = 0;  ///< without faulty ones
  std::int64_t start = 0, end = 0;  ///< [µs] of the first and last event, the file's own time
  int max_x = 0, max_y = 0;         ///< [px]
  RateHistogram rates;
  std::optional<Camera> calibration;
  PoseTrajectory ground_truth;                                ///< empty: none
  std::vector<std::pair<std::string, Faults::Fault>> faults;  ///< oddities
  std::optional<std::string> large_loss;                      ///< EventStream::large_loss

  double duration() const { return static_cast<double>(end - start) * 1e-6; }  ///< [s]
};

/// `progress` is called with the number of events read, and the time reached [µs].
RecordingSummary summarise(const std::string& path, const StreamOptions& options,
                           const std::function<void(std::int64_t, std::int64_t)>& progress = {});

std::string format_summary(const std::string& path, const RecordingSummary& summary);
Json summary_json(const std::string& path, const RecordingSummary& summary);

}  // namespace evbench
