#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bench/pipeline/estimator.hpp"
#include "bench/pipeline/pipeline.hpp"
#include "bench/pipeline/stationary_detector.hpp"
#include "bench/pipeline/stopwatch.hpp"
#include "core/io/sha256.hpp"

namespace evbench {

/// The back-end half of a run. It undistorts the observations of the front-end, repeats the tracks' last positions
/// during stationary periods, re-initialises with a new back-end after tracking was lost, and relocalises the new
/// back-end in the world of an earlier one. Pixels are raw towards the front-end and undistorted towards the back-end.
class BackEndRunner {
 public:
  BackEndRunner(const MakeBackEnd& make, BackEndContext context, const Camera& camera, const TimeRange& range,
                const PipelineOptions& options);

  /// Updates the estimate up to the batch's end.
  void take(const TrackBatch& batch);

  /// Of the estimate at the last batch's end, raw pixels.
  Feedback feedback(const FeedbackNeeds& needs);

  RunProgress progress() const;

  /// Computes the final estimates and fills in the result, except for the facts of the front-end. `rate`: of the final
  /// trajectories [Hz]; 0: the back-end's own poses.
  void finish(double rate, RunResult& result);

  double seconds() const { return watch_.seconds(); }  ///< [s] spent in the back-ends

  /// The same, batch by batch.
  const std::vector<Work>& work() const { return work_; }

 private:
  void start_estimator();
  void digest(const UndistortedBatch& batch);
  void end_estimator(const StationaryDetector::Rejected& stationary);
  void confirm_landmarks(const std::vector<TrackEnd>& ended);
  void relocalise();
  void remember_landmarks();
  void expect_remembered(BackEndFeedback& feedback) const;
  void add_segments(double rate, RunResult& result);
  Status merged_status(const std::vector<bool>& has_segment) const;

  const MakeBackEnd& make_;
  BackEndContext context_;
  const Camera& camera_;
  TimeRange range_;
  StationaryDetector stationary_;
  bool relocalises_;
  std::vector<std::unique_ptr<Estimator>> estimators_;   ///< the last one is active
  double started_ = 0.0, next_relocalisation_ = 0.0;     ///< [s] of the active one; next attempt to relocalise it
  std::optional<Estimator::Relocalisation> last_found_;  ///< result of the last attempt
  /// Landmarks of lost estimators that the active one does not have, in the world that it shares with them.
  std::map<TrackId, Vector3> remembered_;
  double until_, seen_;  ///< [s] of the last batch
  Sha256 hash_;
  std::string digested_;  ///< buffer of digest()
  std::size_t observations_ = 0, left_out_ = 0;
  Stopwatch watch_;
  std::vector<Work> work_;
  double counted_ = 0.0;  ///< [s] of the stopwatch that are in work_
};

}  // namespace evbench
