#pragma once

#include <optional>

#include "core/data/pose_file.hpp"
#include "core/plugin/options.hpp"
#include "core/plugin/source.hpp"

namespace evbench {

/// A recorded sequence: calibration and, where it is known, ground truth. The tracks come from a front-end.
///
/// A `folder` is a recording's folder (core/events/recording_files.hpp): events, and calibration and ground truth in
/// them or in files next to them (core/events/companions/), e.g. calib.txt and groundtruth.txt of the Event-Camera
/// Dataset. Each can be missing, and be named by an option instead. A `dataset` is the folder of a public one that
/// `evbench dataset get` fetched. Without a folder, what is not named is taken from `events`. The sensor's size is the
/// recording's own, or that of the options, the calibration or the files next to the events, in this order; if none
/// states it, it is assumed. Throws InputError for files that are missing or damaged, for two of them that state
/// different sizes, for a time range that is empty or does not meet the ground truth, and if nothing determines how
/// long the sequence is.
class Recording : public Source {
 public:
  struct Options {
    std::string dataset, folder, events, calibration, camera;
    std::string ground_truth, ground_truth_times;
    PoseFormat ground_truth_format = PoseFormat::automatic;
    QuaternionOrder ground_truth_quaternion = QuaternionOrder::automatic;
    TimeUnit ground_truth_time_unit = TimeUnit::unsaid;
    int width = 0, height = 0;
    std::string distortion = "radial_tangential";
    std::vector<double> time_range;
    double time_offset = 0.0;
    std::string columns, topic, ground_truth_topic, camera_info_topic;
    bool lenient = false;

    void declare(OptionSet& set);
  };

  Recording(const Options& options, const SourceContext& context);

  const Camera& camera() const override { return camera_; }
  TimeRange time_range() const override { return range_; }
  const PoseTrajectory& ground_truth() const override { return ground_truth_; }
  /// Times are the file's own, which are the sequence's. Throws InputError for a file that is missing or of no known
  /// format.
  std::unique_ptr<EventReader> all_events() const override;
  std::string size_assumption() const override { return size_assumption_; }
  bool is_lenient() const override { return read_options_.lenient; }
  std::vector<std::string> files() const override { return files_; }
  std::vector<std::string> event_files() const override;
  std::vector<std::string> remarks() const override { return remarks_; }

 private:
  /// What events and the files next to them contain.
  struct Own {
    std::optional<Camera> camera;
    std::optional<PoseTrajectory> ground_truth;
    std::string unusable;  ///< why there is no camera, where one was found
    StreamInfo info;       ///< of the events
  };

  std::string place_, events_;  ///< events: path; empty: none
  ReadOptions read_options_;
  Camera camera_;
  PoseTrajectory ground_truth_;
  TimeRange range_;
  std::string size_assumption_;
  std::vector<std::string> files_, remarks_;

  Own find_own(const Options& options, const std::string& folder);
  void find_info(Own& own) const;
  void set_camera(const Options& options, const std::string& folder, const Own& own);
  void check_sizes(const Options& options, const StreamInfo& recording) const;
  void set_ground_truth(const Options& options, Own& own);
  void set_time_range(const std::vector<double>& range, const Own& own);
  TimeRange time_of_events(const StreamInfo& info) const;
};

}  // namespace evbench
