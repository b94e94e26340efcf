#pragma once

#include <optional>
#include <vector>

#include "core/plugin/backend.hpp"
#include "core/plugin/tracking_monitor.hpp"
#include "core/process/dialogue.hpp"

namespace evbench::process {

/// A back-end in any language: a command that receives observations on its standard input and answers with poses on its
/// standard output (docs/reference/process_protocol.md). Throws ProcessError, from its construction or any call, if the
/// command can't be started, ends, is silent for too long or answers wrongly.
class ProcessBackEnd : public BackEnd {
 public:
  using Options = ProcessOptions;

  ProcessBackEnd(const Options& options, const BackEndContext& context);

  void advance(const UndistortedBatch& batch) override;
  BackEndFeedback feedback(const FeedbackNeeds& needs) override;
  void finish() override;

  Status status() const override { return final_status_.value_or(monitor_.status()); }
  PoseTrajectory trajectory() const override { return trajectory_; }
  /// Covariance of the newest pose, if the last answer had it.
  std::optional<Matrix12> covariance(double t) override;
  std::vector<Landmark> map() const override { return map_; }
  std::span<const UpdateRecord> updates() const override { return updates_; }

 private:
  void take_state(const Json& answer, double until);
  void take_published(const Json& answer, double until);
  void take_newest(const Json& answer, double until);
  void take_final(const Json& answer);
  void take_status(const Json& status);

  BackEndContext context_;
  Dialogue dialogue_;
  TrackingMonitor monitor_;
  BackEndFeedback feedback_;  ///< at the end of the last batch; outliers since the last call of feedback()
  std::optional<Status> final_status_;
  PoseTrajectory trajectory_;
  std::vector<Landmark> map_;
  std::vector<UpdateRecord> updates_;
  bool has_published_ = false;  ///< a causal pose
  int left_out_ = 0;            ///< observations that are not finite
};

}  // namespace evbench::process
