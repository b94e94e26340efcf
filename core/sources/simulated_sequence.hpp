#pragma once

#include <functional>
#include <mutex>

#include "core/plugin/options.hpp"
#include "core/plugin/source.hpp"
#include "core/simulation/motion.hpp"
#include "core/simulation/random.hpp"
#include "core/simulation/scene.hpp"
#include "core/simulation/track_simulator.hpp"
#include "core/sources/simulated_camera.hpp"

namespace evbench {

/// Base of all simulated sequences, from 0 to `duration`, whatever the camera sees: camera, motion, ground truth, and
/// feature tracks with known association. Equal options and seed give equal bytes.
class SimulatedSequence : public Source {
 public:
  struct Options {
    double duration = 30.0;
    std::int64_t seed = -1;
    double ground_truth_rate = 200.0;
    SimulatedCameraOptions camera;
    MotionOptions motion;
    TrackOptions tracks;

    void declare(OptionSet& set);
  };

  const Camera& camera() const override { return camera_; }
  TimeRange time_range() const override { return {0.0, duration_}; }
  const PoseTrajectory& ground_truth() const override { return ground_truth_; }
  std::optional<std::span<const TrackObservation>> true_tracks() const override { return tracks().observations; }
  std::vector<std::string> files() const override { return files_; }

  /// Made on first use: a front-end that reads events does not need them, and occlusion tests take time. Throws
  /// InputError if the options can't be met.
  const SimulatedTracks& tracks() const;

 protected:
  SimulatedSequence(const Options& options, const SourceContext& context);

  /// Each part draws from a stream of its own: other tracks do not change the motion.
  enum class Part : std::uint64_t { motion = 1, tracks = 2, scene = 3, sensor = 4 };
  Random random(Part part) const { return Random(seed_, static_cast<std::uint64_t>(part)); }

  double duration() const { return duration_; }
  const Motion& motion() const { return motion_; }
  /// `scene`: makes the scene when tracks are requested; `place`: of the options, for messages.
  void make_tracks_of(std::function<Scene()> scene, const TrackOptions& options, const std::string& place);
  const std::vector<std::string>& motion_remarks() const { return motion_remarks_; }  ///< on its file, if it has one
  void add_file(const std::string& path) { files_.push_back(path); }

 private:
  double duration_;
  std::uint64_t seed_;
  Camera camera_;
  std::vector<std::string> motion_remarks_;
  Motion motion_;
  PoseTrajectory ground_truth_;
  std::function<SimulatedTracks()> make_tracks_;
  mutable std::once_flag made_;
  mutable SimulatedTracks tracks_;
  std::vector<std::string> files_;
};

}  // namespace evbench
