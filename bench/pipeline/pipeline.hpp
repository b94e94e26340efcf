#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bench/pipeline/batch_stream.hpp"
#include "bench/pipeline/options.hpp"
#include "bench/pipeline/stationary_detector.hpp"
#include "bench/pipeline/trajectory_segment.hpp"
#include "core/plugin/backend.hpp"
#include "core/plugin/frontend.hpp"
#include "core/plugin/source.hpp"

namespace evbench {

/// Wall time of a run by part [s].
struct RunTimes {
  double source = 0.0;                   ///< the front-end waits for events that are read, decoded or simulated
  double frontend = 0.0;                 ///< front-end
  double backend = 0.0;                  ///< back-end
  double waiting = 0.0;                  ///< the back-end's thread waits for the front-end's
  double harness = 0.0;                  ///< the rest of the loop: exchanges, undistortion, hashing, sampling
  double total = 0.0;                    ///< of the loop, from the first exchange to the last estimate
  std::vector<double> frontend_batches;  ///< `frontend`, exchange by exchange
  /// Data time / processing time of the slowest 5 s of the data, without the final estimate; none for shorter data.
  std::optional<double> slowest_5s;
};

/// Result of a run of front-end and back-end.
struct RunResult {
  Status status;                            ///< of the whole run
  std::vector<TrajectorySegment> segments;  ///< in order of their beginnings; empty if the run failed
  std::size_t longest = 0;                  ///< index of the segment that covers the longest time: the scored one
  std::vector<StationaryPeriod> stationary;
  std::vector<UpdateRecord> updates;
  std::vector<std::string> estimated_parameters;  ///< names of the values UpdateRecord::estimated
  RunTimes times;
  double data_s = 0.0;        ///< [s] from the first to the last observation of the front-end
  double peak_rss_mib = 0.0;  ///< of the process during the run, source and tracks included
  std::string tracks_sha256;  ///< of all input of the back-end: equal for runs that can be compared
  std::size_t observations = 0;
  std::optional<TrackBatch> tracks;  ///< all output of the front-end, raw pixels, if it is kept
  std::vector<RunEvent> events;
  std::map<std::string, std::int64_t> counters;  ///< of the back-ends
  std::vector<std::string> log;
};

/// Progress of a run.
struct RunProgress {
  double t = 0.0, end = 0.0;  ///< [s] sequence time that the estimate has reached; the range's end
  std::size_t tracks = 0;     ///< live tracks
  int states = 0, landmarks = 0;
  double delay = 0.0;                          ///< [s] data time from the newest pose to the end of the processed data
  double backend_s = 0.0;                      ///< [s] wall time in the back-ends
  std::optional<double> realtime_factor = {};  ///< so far, as in the tables; none with recorded batches
};

/// Called after each exchange.
using Progress = std::function<void(const RunProgress&)>;

/// Makes a back-end; called again after tracking was lost.
using MakeBackEnd = std::function<std::unique_ptr<BackEnd>(const BackEndContext&)>;

/// Runs front-end and back-end from the beginning of the source's time range to its end. Of `context` the camera,
/// patience, publish, event and log are set here. `trajectory_rate`: of the final trajectories [Hz]; 0: the back-end's
/// own poses. `keep_tracks`: fills RunResult::tracks.
RunResult run_pipeline(const Source& source, FrontEnd& frontend, const MakeBackEnd& make_backend,
                       BackEndContext context, const PipelineOptions& options, double trajectory_rate,
                       const Progress& progress = {}, bool keep_tracks = false);

/// The same with recorded batches (batch_recording.hpp) in place of a front-end. Results are identical to those with
/// the front-end, and its recorded times are reported. In mode "sequential" the total includes them.
RunResult run_pipeline(const Source& source, BatchStream& batches, const MakeBackEnd& make_backend,
                       BackEndContext context, const PipelineOptions& options, double trajectory_rate,
                       const Progress& progress = {}, bool keep_tracks = false);

}  // namespace evbench
