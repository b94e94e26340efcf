#pragma once

#include "core/plugin/registry.hpp"

namespace evbench {

/// A recorded sequence: calibration and, where it is known, ground truth. The tracks come from a front-end.
///
/// A `folder` in the Event-Camera Dataset's layout holds calib.txt and groundtruth.txt (which may be missing); both can
/// be named one by one instead. A `dataset` is the folder of a public one that `evbench dataset get` fetched. Events
/// come from the file `events` of any format, or from the folder: its events.evb (a native copy that `evbench convert`
/// made) before others. Paths may have ${EVBENCH_DATA}. Throws InputError for files that are missing or
/// damaged, for a time range that is empty or that the ground truth does not meet, and when neither says how long the
/// sequence is.
class Recording : public Source {
 public:
  struct Options {
    std::string dataset, folder, events, calibration, ground_truth;
    std::string ground_truth_format = "tum";
    int width = 240, height = 180;
    std::string distortion = "radial_tangential";
    std::vector<double> time_range;
    double time_offset = 0.0;

    void declare(OptionSet& set);
  };

  Recording(const Options& options, const SourceContext& context);

  const Camera& camera() const override { return camera_; }
  TimeRange time_range() const override { return range_; }
  const PoseTrajectory& ground_truth() const override { return ground_truth_; }
  /// All of them: times are the file's own, which are the sequence's. Throws InputError for a file that is missing or of
  /// no known format.
  std::unique_ptr<EventReader> events() const override;
  std::vector<std::string> files() const override { return files_; }
  std::vector<std::string> remarks() const override { return remarks_; }

 private:
  std::string place_, events_;  ///< events: path; empty: none
  Camera camera_;
  PoseTrajectory ground_truth_;
  TimeRange range_;
  std::vector<std::string> files_, remarks_;

  void read_camera(const Options& options, const std::string& folder);
  void read_ground_truth(const Options& options, const std::string& folder);
  void set_time_range(const std::vector<double>& range);
};

}  // namespace evbench
