#include "bench/render/run_overlay.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <opencv2/imgproc.hpp>

#include "bench/render/track_overlay.hpp"
#include "core/data/map_file.hpp"
#include "core/data/tracks.hpp"
#include "core/data/tum.hpp"
#include "core/support/error.hpp"
#include "eval/alignment.hpp"
#include "eval/score_run.hpp"

namespace evbench {
namespace {

constexpr double kAlive = 0.25;      ///< [s] without an observation after which a track counts as lost
constexpr double kFoundAgain = 0.7;  ///< [s] for which a re-acquired landmark is marked

std::string file_of(const std::string& folder, const char* name, const char* hint) {
  const std::string path = folder + "/" + name;
  if (!std::filesystem::is_regular_file(path)) {
    throw InputError(fmt::format("{}: has no {}; expected a run's folder{}", folder, name, hint));
  }
  return path;
}

std::vector<StampedPose> aligned(const PoseTrajectory& estimate, const PoseTrajectory& truth) {
  std::vector<StampedPose> result = estimate.poses();
  AssociationOptions options;
  options.mode = AssociationMode::interpolated;
  const Alignment alignment = align(associate(truth, estimate, options).pairs, AlignmentMethod::sim3);
  for (StampedPose& pose : result) pose.T = alignment.transform * pose.T;
  return result;
}

/// The two axes with the largest extent of the positions, and the extents.
struct Frame {
  std::array<int, 2> axes{};
  std::array<double, 2> from{}, to{};
};
Frame frame_of(const std::vector<StampedPose>& poses) {
  Vector3 low = poses.front().T.p, high = low;
  for (const StampedPose& pose : poses) {
    low = low.cwiseMin(pose.T.p);
    high = high.cwiseMax(pose.T.p);
  }
  std::array<int, 3> order = {0, 1, 2};
  std::ranges::sort(order, std::greater<>(), [&](int axis) { return high[axis] - low[axis]; });
  Frame frame;
  for (std::size_t i = 0; i < 2; ++i) {
    frame.axes[i] = order[i];
    frame.from[i] = low[order[i]];
    frame.to[i] = high[order[i]];
  }
  return frame;
}

}  // namespace

RunOverlay::RunOverlay(const std::string& folder, const Camera& camera)
    : camera_(camera),
      tracks_(read_tracks(file_of(folder, "tracks.txt", " that was made by evbench run --tracks"), camera.width,
                          camera.height)
                  .observations),
      map_(read_map(file_of(folder, "map.ply", ""))),
      estimate_(read_run_poses(folder, {})) {
  for (const TrackObservation& z : tracks_) times_[z.track].push_back(z.t);
  aligned_ = estimate_.poses();
  if (estimate_.empty()) remark_ = fmt::format("{}: has no trajectory; its tracks are drawn", folder);
  if (!std::filesystem::exists(folder + "/groundtruth.tum")) return;
  const PoseTrajectory truth = read_tum(folder + "/groundtruth.tum");
  if (estimate_.empty()) {
    truth_ = truth.poses();
    return;
  }
  try {
    aligned_ = aligned(estimate_, truth);
    truth_ = truth.cut(estimate_.start(), estimate_.end()).poses();
  } catch (const InputError& error) {  // few poses, or none at the ground truth's times
    remark_ = fmt::format("{}: the ground truth is left out: {}", folder, error.what());
  }
}

RunOverlay::Sight RunOverlay::sight_of(TrackId track, double t) const {
  const auto found = times_.find(track);
  if (found == times_.end() || found->second.front() > t) return Sight::unseen;
  const std::vector<double>& times = found->second;
  auto at = std::ranges::upper_bound(times, t) - 1;
  if (t - *at > kAlive) return Sight::lost;
  for (; at != times.begin() && t - *at < kFoundAgain; --at) {
    if (*at - *(at - 1) > kAlive) return Sight::found_again;
  }
  return Sight::tracked;
}

void RunOverlay::draw_landmarks(double t, int scale, const Palette& palette, Picture& picture) const {
  const auto T = estimate_.empty() ? std::nullopt : estimate_.pose(t);
  if (!T) return;
  const SE3 T_camera_world = T->inverse();
  const int radius = 2 * scale;  // [px]
  for (const Landmark& landmark : map_) {
    const Vector3 point = T_camera_world * landmark.position;
    if (!(point.z() > 0.0)) continue;
    const Vector2 pixel = camera_.project(point);
    if (!camera_.contains(pixel)) continue;
    const Sight sight = sight_of(landmark.track, t);
    const cv::Point place = enlarged(pixel, scale);
    if (sight == Sight::lost) {
      const cv::Point arm(radius << (kFractionBits - 1), radius << (kFractionBits - 1)), other(arm.x, -arm.y);
      cv::line(picture, place - arm, place + arm, scalar(palette.frame), 2, cv::LINE_AA, kFractionBits);
      cv::line(picture, place - other, place + other, scalar(palette.frame), 2, cv::LINE_AA, kFractionBits);
    } else if (sight != Sight::unseen) {
      const bool again = sight == Sight::found_again;
      cv::circle(picture, place, (again ? 2 * radius : radius) << kFractionBits,
                 scalar(track_colour(landmark.track, palette)), again ? 3 : 1, cv::LINE_AA, kFractionBits);
    }
  }
}

Picture RunOverlay::draw_trajectory(double t, int size, const Palette& palette) const {
  Picture picture(size, size, palette.background);
  std::vector<StampedPose> all = aligned_;
  all.insert(all.end(), truth_.begin(), truth_.end());
  if (all.empty()) return picture;
  const Frame frame = frame_of(all);
  const double width = std::max(1e-9, std::max(frame.to[0] - frame.from[0], frame.to[1] - frame.from[1]));
  const auto place = [&](const Vector3& p) {
    std::array<double, 2> at{};
    for (std::size_t i = 0; i < 2; ++i) {
      const double middle = 0.5 * (frame.from[i] + frame.to[i]);
      at[i] = size * (0.5 + 0.9 * (p[frame.axes[i]] - middle) / width);
    }
    const auto fixed = [](double value) { return static_cast<int>(std::lround(std::ldexp(value, kFractionBits))); };
    return cv::Point(fixed(at[0]), fixed(size - at[1]));
  };
  const auto draw = [&](const std::vector<StampedPose>& poses, double until, const Colour& colour, int thickness) {
    for (std::size_t i = 1; i < poses.size() && poses[i].t <= until; ++i) {
      cv::line(picture, place(poses[i - 1].T.p), place(poses[i].T.p), scalar(colour), thickness, cv::LINE_AA,
               kFractionBits);
    }
  };
  draw(truth_, truth_.empty() ? t : truth_.back().t, palette.frame, 1);
  draw(aligned_, t, palette.off, 2);
  const auto now = std::ranges::upper_bound(aligned_, t, {}, &StampedPose::t);
  if (now != aligned_.begin()) {
    cv::circle(picture, place((now - 1)->T.p), (size / 80 + 2) << kFractionBits, scalar(palette.on), cv::FILLED,
               cv::LINE_AA, kFractionBits);
  }
  return picture;
}

}  // namespace evbench
