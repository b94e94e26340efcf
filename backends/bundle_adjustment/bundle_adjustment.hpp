#pragma once

#include <optional>
#include <set>
#include <string>
#include <vector>

#include "backends/bundle_adjustment/bundle_solver.hpp"
#include "backends/bundle_adjustment/frames.hpp"
#include "backends/bundle_adjustment/options.hpp"
#include "backends/bundle_adjustment/reconstruction.hpp"
#include "core/plugin/backend.hpp"
#include "core/plugin/tracking_monitor.hpp"

namespace evbench::bundle_adjustment {

/// The baseline that the paper compares with: asynchronous observations are grouped into frames, a feature's place in a
/// frame is the mean of its observations there, and incremental structure from motion estimates a pose for each frame.
///
/// A new frame's pose: constant-velocity prediction, refined on the landmarks that it sees (PnP with RANSAC when that
/// fails). Then new landmarks, bundle adjustment of a window of frames (older ones held), removal of outlier tracks.
/// Then the window's poses are told anew, for whoever can wait for better ones. At the end: bundle adjustment of
/// everything. World: the camera at the first frame used; unit: the median depth of the first landmarks.
///
/// With too few landmarks in sight a pose is predicted (`degraded`), and the map starts afresh from two new views,
/// placed at the predicted pose and scaled so that the median depth stays what it was. Without success for the
/// context's patience it is `lost`, and nothing follows the last estimated pose.
class BundleAdjustment : public BackEnd {
 public:
  using Options = bundle_adjustment::Options;

  BundleAdjustment(const Options& options, const BackEndContext& context);

  void advance(const TrackBatch& batch) override;
  Feedback feedback(const FeedbackNeeds& needs) override;
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
  FrameBuilder frames_;
  Reconstruction map_;
  std::vector<Segment> segments_;
  std::vector<UpdateRecord> updates_;

  TrackBuffer means_;  ///< frame means since the last initialisation was needed
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

  void process(Frame frame);
  void publish_newest(int view, int oldest, double known_at) const;
  SolveReport initialise(int view);
  Trial try_guess(const InitialGuess& guess, int view) const;
  void accept(Trial trial, int view);
  SolveReport track(int view);
  std::string locate(int view);
  void remember(int view);
  void start_over();
  void pass_time(double t);
  std::vector<ExpectedFeature> expected_features() const;
  void learn_noise(int first);
  SolveReport solve_window(int view);
  bool remove_outliers(int first);
  void update_motion(int view);
  void solve_segment(const Segment& segment, int last);
  void fill_predicted();
};

}  // namespace evbench::bundle_adjustment
