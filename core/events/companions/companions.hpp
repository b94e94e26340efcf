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

/// What lies beside a recording's events in files of its own, as public data sets lay it there.
struct Companions {
  struct Calibration {
    std::vector<std::string> names;  ///< of files, relative to the recording's folder
    std::string whose;               ///< e.g. "cam0, DSEC's left event camera"
    /// Sensor [px] for a file that doesn't say it. Throws InputError, naming file and key.
    std::function<Camera(int width, int height)> read;
  };
  struct GroundTruth {
    std::vector<std::string> names;
    std::string whose;  ///< the body that the poses are of
    std::function<PoseFile()> read;
    std::string remark = {};  ///< a sentence where that isn't the camera
  };
  struct Sensor {
    int width, height;  ///< [px]
    std::string whose;
  };
  std::optional<Calibration> calibration;
  std::optional<GroundTruth> ground_truth;
  std::optional<Sensor> sensor;  ///< of the data set, where nothing else says it
};

/// `topic` as in ReadOptions: whose events.
Companions find_companions(const std::shared_ptr<const RecordingFiles>& files, const std::string& topic);

/// The reader with what lies beside its events where it has no calibration or ground truth itself; their poses, and the
/// sensor's size where it was only assumed and no option says it. Metadata says what is from where: "calibration",
/// "ground truth", "remark"; what was assumed in reading the ground truth is a remark as soon as it was asked for.
std::unique_ptr<EventReader> with_companions(std::unique_ptr<EventReader> reader,
                                             const std::shared_ptr<const RecordingFiles>& files,
                                             const ReadOptions& options);

}  // namespace evbench
