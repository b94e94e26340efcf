#pragma once

#include <optional>
#include <set>
#include <string>
#include <vector>

#include "backends/bundle_adjustment/batches.hpp"
#include "backends/bundle_adjustment/bundle_solver.hpp"
#include "backends/bundle_adjustment/options.hpp"
#include "backends/bundle_adjustment/reconstruction.hpp"
#include "core/plugin/backend.hpp"
#include "core/plugin/tracking_monitor.hpp"

namespace evbench::bundle_adjustment {

/// The baseline of the paper. Asynchronous observations are grouped into batches, as if a camera with frames had seen
/// them; a feature's position in a batch is the mean of its observations there; incremental structure from motion
/// estimates a pose for each batch.
///
/// For each new batch, the pose is predicted with constant velocity and refined on the landmarks that it sees (PnP with
/// RANSAC if that fails). Then follow new landmarks, bundle adjustment of a window of batches (older ones held), and
/// the removal of outlier tracks. Then the window's poses are published again, as improved estimates. At the end
/// everything is bundle adjusted. World frame: the camera at the first batch used; unit: the median depth of the first
/// landmarks.
///
/// With too few landmarks in view a pose is predicted (`degraded`), and a new map is initialised from two new views,
/// placed at the predicted pose and scaled so that the median depth stays the same. Without success within the
/// context's patience it is `lost`, and no pose follows the last estimated one.
class BundleAdjustment : public BackEnd {
 public:
  using Options = bundle_adjustment::Options;

  BundleAdjustment(const Options& options, const BackEndContext& context);

  void advance(const UndistortedBatch& batch) override;
  BackEndFeedback feedback(const FeedbackNeeds& needs) override;
  void finish() override;

  Status status() const override { return monitor_.status(); }
  PoseTrajectory trajectory() const override;
  std::vector<Landmark> map() const override;
  std::span<const UpdateRecord> updates() const override { return updates_; }

 private:
  /// Views that share one map, from `first` to the next segment's.
  struct Segment {
    int first = 0, scale = 0;  ///< views that hold origin and scale
  };

  Options options_;
  BackEndContext context_;
  BatchBuilder batches_;
  Reconstruction map_;
  std::vector<Segment> segments_;
  std::vector<UpdateRecord> updates_;

  TrackBuffer means_;  ///< means of batches since an initialisation was needed
  Initialiser initialiser_;
  std::string waiting_for_;  ///< why there is no map yet

  Vector6 velocity_ = Vector6::Zero();
  double noise_factor_ = 1.0;  ///< on the keypoints' sigmas
  double median_depth_ = 1.0;  ///< of the landmarks in the last estimated view
  bool failing_ = false;       ///< the newest views' poses are predicted
  TrackingMonitor monitor_;
  double until_ = 0.0, last_observation_ = 0.0;  ///< [s]
  std::set<TrackId> live_;                       ///< tracks that have been observed and have not ended
  std::set<TrackId> removed_;
  std::vector<TrackId> new_outliers_;

  struct Trial;
  InitialiserOptions initialiser_options() const;
  TriangulationOptions triangulation_options() const;
  SolverOptions solver_options(int iterations) const;
  int view_at(double t) const;
  SE3 predict(double t, int from) const;

  void process(Batch batch);
  void publish_newest(int view, int oldest, double known_at) const;
  SolveReport initialise(int view);
  Trial try_guess(const InitialGuess& guess, int view) const;
  void accept(Trial trial, int view);
  SolveReport track(int view);
  std::string locate(int view);
  void remember(int view);
  void reset_initialisation();
  void pass_time(double t);
  std::vector<UndistortedFeature> expected_features() const;
  void learn_noise(int first);
  SolveReport solve_window(int view);
  bool remove_outliers(int first);
  void update_motion(int view);
  void solve_segment(const Segment& segment, int last);
  void fill_predicted();
};

}  // namespace evbench::bundle_adjustment
