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

/// The back-end's side of a run: undistorts what the front-end saw, holds tracks while the camera stands still,
/// gives a back-end that is lost a successor, and finds that one's world in the world of those before it. Pixels are
/// raw on the front-end's side of it, undistorted on the other.
class BackEndRunner {
 public:
  BackEndRunner(const MakeBackEnd& make, BackEndContext context, const Camera& camera, const TimeRange& range,
           const PipelineOptions& options);

  /// Brings the estimate up to the batch's end.
  void take(TrackBatch batch);

  /// What it then knows.
  Feedback feedback(const FeedbackNeeds& needs);

  RunProgress progress() const;

  /// Makes the final estimates and writes all of it into the result, but for what the front-end's side knows. `rate`:
  /// of the final trajectories [Hz]; 0: the back-end's own poses.
  void finish(double rate, RunResult& result);

  double seconds() const { return watch_.seconds(); }  ///< in the back-ends
  const std::vector<Work>& work() const {
    return work_;
  }  ///< of that, until each batch was taken, since the one before

 private:
  void begin();
  void undistort(TrackBatch& batch);
  void digest(const TrackBatch& batch);
  void take_back(const StationaryDetector::Rejected& stand);
  void resolve_doubts(const std::vector<TrackEnd>& ended);
  void relocalise();
  void remember_landmarks();
  void expect_remembered(Feedback& feedback) const;
  void add_segments(double rate, RunResult& result);
  Status merged_status(const std::vector<bool>& has_segment) const;

  const MakeBackEnd& make_;
  BackEndContext context_;
  const Camera& camera_;
  TimeRange range_;
  StationaryDetector stationary_;
  bool relocalises_;
  std::vector<std::unique_ptr<Estimator>> estimators_;  ///< the last one is at work
  double begun_ = 0.0, next_relocalisation_ = 0.0;      ///< [s] when it began; when its world is next looked for
  std::optional<Estimator::Found> found_;               ///< where it was last found
  /// Of estimators that were lost, in whose world the present one stands; it doesn't know them itself. In that world.
  std::map<TrackId, Vector3> remembered_;
  double until_, seen_;  ///< [s] of the last batch
  Sha256 hash_;
  std::string digested_;  ///< what is to be hashed
  std::size_t observations_ = 0, left_out_ = 0;
  Stopwatch watch_;
  std::vector<Work> work_;
  double counted_ = 0.0;  ///< [s] of the stopwatch
};

}  // namespace evbench
