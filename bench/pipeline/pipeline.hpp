#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bench/pipeline/batch_stream.hpp"
#include "bench/pipeline/options.hpp"
#include "bench/pipeline/trajectory_segment.hpp"
#include "bench/pipeline/stationary_detector.hpp"
#include "core/plugin/backend.hpp"
#include "core/plugin/frontend.hpp"
#include "core/plugin/source.hpp"

namespace evbench {

/// Where the time of a run went [s], wall clock.
struct RunTimes {
  double source = 0.0;    ///< the front-end's waiting for events that are read, decoded or simulated
  double frontend = 0.0;  ///< making observations
  double backend = 0.0;   ///< estimating
  double waiting = 0.0;   ///< the back-end's thread, for the front-end's
  double harness = 0.0;   ///< the rest of the loop: exchanges, undistortion, hashing, sampling
  double total = 0.0;     ///< of the loop, from the first exchange to the last estimate
  /// Making observations, of each exchange.
  std::vector<double> frontend_batches;
  /// Data time / processing time of the slowest 5 s of the data, without the final estimate; none: there are fewer.
  std::optional<double> slowest_5s;
};

/// What a run of front-end and back-end ended with.
struct RunResult {
  Status status;              ///< of the whole run
  std::vector<TrajectorySegment> segments;  ///< in the order of their beginnings; none when the run failed
  std::size_t longest = 0;    ///< of the segments, by the time that it covers: the one that is scored
  std::vector<StationaryPeriod> stationary;
  std::vector<UpdateRecord> updates;
  std::vector<std::string> learnt;  ///< names of the updates' `learnt`
  RunTimes times;
  double data_s = 0.0;        ///< [s] from the first to the last observation that the front-end gave
  double peak_rss_mib = 0.0;  ///< of the process during the run, source and tracks included
  std::string tracks_sha256;  ///< of all that the back-end was given: equal for runs that can be compared
  std::size_t observations = 0;
  std::optional<TrackBatch> tracks;  ///< all that the front-end published, raw pixels; where it is to be kept
  std::vector<std::string> log;
};

/// How far a run is.
struct RunProgress {
  double t = 0.0, end = 0.0;  ///< [s] sequence time that the estimate has reached; the range's end
  std::size_t tracks = 0;     ///< alive
  int states = 0, landmarks = 0;
  double delay = 0.0;                     ///< [s] data time by which the newest pose is behind what has been looked at
  double backend_s = 0.0;                 ///< [s] that the back-ends have taken
  std::optional<double> realtime_factor = {};  ///< so far, as tables have it
};

/// Called after each exchange; the factor is known where the front-end itself is at work.
using Progress = std::function<void(const RunProgress&)>;

/// Makes a back-end; called again after a loss.
using MakeBackEnd = std::function<std::unique_ptr<BackEnd>(const BackEndContext&)>;

/// Front-end and back-end from the beginning of the source's time range to its end. `context` has the camera's pinhole,
/// patience, sink and log set here. `trajectory_rate`: of the final trajectories [Hz]; 0: the back-end's own poses.
/// `keep_tracks`: in RunResult::tracks.
RunResult run_pipeline(const Source& source, FrontEnd& frontend, const MakeBackEnd& make_backend,
                       BackEndContext context, const PipelineOptions& options, double trajectory_rate,
                       const Progress& progress = {}, bool keep_tracks = false);

/// Likewise of batches that are known beforehand (batch_recording.hpp): the same bytes as with the front-end itself,
/// and its times. The total is then what it would have been, where both work in one thread.
RunResult run_pipeline(const Source& source, BatchStream& batches, const MakeBackEnd& make_backend,
                       BackEndContext context, const PipelineOptions& options, double trajectory_rate,
                       const Progress& progress = {});

}  // namespace evbench
