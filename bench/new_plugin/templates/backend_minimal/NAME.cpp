// The back-end NAME for evbench, in the fewest lines that run: the camera moves opposite to the mean observed pixel.
#include <evbench/plugin.hpp>

namespace {

using namespace evbench;

class ClassName : public evbench::BackEnd {
 public:
  struct Options {
    void declare(OptionSet&) {}
  };

  ClassName(const Options&, const BackEndContext& context) : context_(context) {}

  void advance(const UndistortedBatch& batch) override {
    if (batch.observations.empty()) return;
    SE3 T;  // T_world_camera
    for (const UndistortedObservation& z : batch.observations) {
      T.p.head<2>() -= z.pixel / (context_.camera.fx * static_cast<double>(batch.observations.size()));
    }
    const StampedPose pose{batch.observations.back().t, T};
    if (!poses_.empty() && pose.t <= poses_.back().t) return;
    poses_.push_back(pose);
    context_.publish({pose});
  }

  BackEndFeedback feedback(const FeedbackNeeds&) override { return {}; }
  void finish() override {}
  Status status() const override { return poses_.empty() ? Status{RunState::failed, "no observations"} : Status{}; }
  PoseTrajectory trajectory() const override { return PoseTrajectory(poses_); }
  std::vector<Landmark> map() const override { return {}; }

 private:
  BackEndContext context_;
  std::vector<StampedPose> poses_;
};

const Registration<evbench::BackEnd, ClassName> registration("NAME", "template: the fewest lines that run");

}  // namespace
