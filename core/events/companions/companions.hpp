#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/data/pose_file.hpp"
#include "core/events/reader.hpp"
#include "core/events/recording_files.hpp"

namespace evbench {

/// Calibration, ground truth and sensor size from files next to a recording's events, as public data sets lay them out.
struct Companions {
  struct Calibration {
    std::vector<std::string> names;  ///< of files, relative to the recording's folder
    std::string whose;               ///< e.g. "cam0, DSEC's left event camera"
    /// `width`, `height`: sensor [px] for a file that does not state it. Throws InputError, naming file and key.
    std::function<Camera(int width, int height)> read;
  };
  struct GroundTruth {
    std::vector<std::string> names;
    std::string whose;  ///< the body that the poses describe
    std::function<PoseFile()> read;
    std::string remark = {};  ///< a sentence if that body is not the camera
  };
  struct Sensor {
    int width, height;  ///< [px]
    std::string whose;
  };
  std::optional<Calibration> calibration;
  std::optional<GroundTruth> ground_truth;
  std::optional<Sensor> sensor;  ///< the data set's, if nothing else states it
};

/// `topic`: of the events, as in ReadOptions.
Companions find_companions(const std::shared_ptr<const RecordingFiles>& files, const std::string& topic);

/// Adds to a reader the calibration and the ground truth of its companion files where it has none itself, and the
/// sensor's size where it was only assumed and no option states it. Metadata states the origin: "calibration", "ground
/// truth", "remark". Assumptions made in reading the ground truth become remarks once it is read.
std::unique_ptr<EventReader> with_companions(std::unique_ptr<EventReader> reader,
                                             const std::shared_ptr<const RecordingFiles>& files,
                                             const ReadOptions& options);

}  // namespace evbench
