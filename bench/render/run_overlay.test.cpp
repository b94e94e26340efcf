#include "bench/render/run_overlay.hpp"

#include <filesystem>

#include "core/data/map_file.hpp"
#include "core/data/tracks.hpp"
#include "core/data/tum.hpp"
#include "core/io/atomic_file.hpp"
#include "core/support/error.hpp"
#include "core/testing/catch2.hpp"
#include "core/testing/data.hpp"

using namespace evbench;
using namespace evbench::testing;

namespace {

const Colour kWhite(255, 255, 255);

Camera camera() {
  Camera result;
  result.width = 100;
  result.height = 80;
  result.pinhole = {100.0, 100.0, 50.0, 40.0};
  return result;
}

/// A camera that moves along x for 4 s, and three landmarks: track 1 is seen all the time, 2 until 1 s and again from 3
/// s on, 3 not before 2 s.
void write_run(const TemporaryFolder& folder) {
  std::vector<StampedPose> poses;
  std::vector<TrackObservation> tracks;
  for (int i = 0; i <= 400; ++i) {
    const double t = 0.01 * i;
    poses.push_back({t, {Eigen::Quaterniond::Identity(), {0.01 * t, 0.002 * t * t, 0.0}}});
    tracks.push_back({1, t, {20.0, 20.0}, 1.0});
    if (t < 1.0 || t > 3.0) tracks.push_back({2, t, {50.0, 40.0}, 1.0});
    if (t > 2.0) tracks.push_back({3, t, {80.0, 60.0}, 1.0});
  }
  write_file(folder.file("tracks.txt"), format_tracks(tracks));
  write_file(folder.file("map.ply"),
             format_map(std::vector<Landmark>{{1, {-0.3, -0.2, 1.0}}, {2, {0.0, 0.0, 1.0}}, {3, {0.3, 0.2, 1.0}}}));
  write_file(folder.file("final.tum"), format_tum(PoseTrajectory(poses)));
  write_file(folder.file("groundtruth.tum"), format_tum(PoseTrajectory(std::move(poses))));
}

int drawn(const Picture& picture) {
  return static_cast<int>(std::ranges::count_if(picture, [](const Colour& colour) { return colour != kWhite; }));
}

/// Pixels drawn in the landmarks' surroundings at t: of tracks 1, 2 and 3.
std::array<int, 3> drawn_at(const RunOverlay& overlay, double t) {
  constexpr int kScale = 4;
  Picture picture(80 * kScale, 100 * kScale, kWhite);
  overlay.draw_landmarks(t, kScale, light_palette(), picture);
  std::array<int, 3> result{};
  for (int i = 0; i < 3; ++i) {
    result[static_cast<std::size_t>(i)] =
        drawn(picture(cv::Rect((20 + 30 * i - 9) * kScale, (20 + 20 * i - 9) * kScale, 18 * kScale, 18 * kScale)));
  }
  return result;
}

}  // namespace

TEST_CASE("Landmarks are drawn as tracked, lost and re-acquired, and not before they were seen") {
  const TemporaryFolder folder;
  write_run(folder);
  const RunOverlay overlay(folder.path(), camera());
  const auto early = drawn_at(overlay, 0.9), lost = drawn_at(overlay, 1.9), again = drawn_at(overlay, 3.3);
  CHECK(early[0] > 0);
  CHECK(early[1] > 0);
  CHECK(early[2] == 0);
  CHECK(lost[1] > 0);
  CHECK(lost[1] != early[1]);      // a cross, not a ring
  CHECK(again[1] > 2 * early[1]);  // a bold ring
  CHECK(again[2] > 0);
}

TEST_CASE("The trajectory grows with time, over all of the truth") {
  const TemporaryFolder folder;
  write_run(folder);
  const RunOverlay overlay(folder.path(), camera());
  const int before = drawn(overlay.draw_trajectory(-1.0, 200, light_palette()));
  const int half = drawn(overlay.draw_trajectory(2.0, 200, light_palette()));
  CHECK(before > 0);
  CHECK(half > before);
  CHECK(drawn(overlay.draw_trajectory(4.0, 200, light_palette())) > half);
}

TEST_CASE("For a run without a trajectory the tracks and the ground truth are drawn") {
  const TemporaryFolder folder;
  write_run(folder);
  write_file(folder.file("final.tum"), "");
  write_file(folder.file("map.ply"), format_map(std::vector<Landmark>{}));
  const RunOverlay overlay(folder.path(), camera());
  CHECK(overlay.tracks().size() > 400);
  CHECK_THAT(overlay.remark(), Catch::Matchers::ContainsSubstring("has no trajectory"));
  CHECK(drawn_at(overlay, 0.9) == std::array<int, 3>{0, 0, 0});
  CHECK(drawn(overlay.draw_trajectory(2.0, 200, light_palette())) > 0);
  std::filesystem::remove(folder.file("groundtruth.tum"));
  CHECK(drawn(RunOverlay(folder.path(), camera()).draw_trajectory(2.0, 200, light_palette())) == 0);
}

TEST_CASE("A trajectory that can't be aligned with the truth is drawn alone, with a remark") {
  const TemporaryFolder folder;
  write_run(folder);
  write_file(folder.file("final.tum"), "1 0 0 0 0 0 0 1\n1.01 0.1 0 0 0 0 0 1\n");
  const RunOverlay overlay(folder.path(), camera());
  CHECK_THAT(overlay.remark(), Catch::Matchers::ContainsSubstring("the ground truth is left out: "));
  CHECK(drawn(overlay.draw_trajectory(2.0, 200, light_palette())) > 0);
  write_run(folder);
  CHECK(RunOverlay(folder.path(), camera()).remark().empty());
}

TEST_CASE("A folder without tracks is refused with the command that makes them") {
  const TemporaryFolder folder;
  write_run(folder);
  std::filesystem::remove(folder.file("tracks.txt"));
  CHECK_THROWS_WITH(RunOverlay(folder.path(), camera()), Catch::Matchers::ContainsSubstring("--tracks"));
}
