#include "frontends/str/motion/motion_tracks.hpp"

#include <map>

#include "core/geometry/so3.hpp"
#include "core/testing/catch2.hpp"
#include "core/testing/collect_tracks.hpp"
#include "core/testing/event_scene.hpp"

using namespace evbench;
using namespace evbench::str;
using evbench::testing::collect_tracks;
using evbench::testing::EventScene;
using evbench::testing::same;

namespace {

/// To and fro, reversing every 0.26 s, first at 0.13 s.
SE3 to_and_fro(double t) { return {so3::exp(Vector3(0.1, 0.25, 0.05) * std::sin(12.0 * t)), Vector3::Zero()}; }

const EventScene& motion_scene() {
  static const EventScene result(to_and_fro, 1.0, EventScene::quadrangles(150, 1));
  return result;
}

struct ReportedMotion {
  TrackBatch all;
  std::vector<std::string> remarks;
};

ReportedMotion follow_motion(const Source& source, const MotionTracksOptions& options = {}, double interval = 0.01,
                             std::size_t most = 0) {
  MotionTracks motion(options, {source, 0, ""});
  return {collect_tracks(motion, source, interval, most), motion.remarks()};
}

/// Distance of each observation from its first one, moved by the true rotation since then [px].
std::vector<double> errors(const Source& source, const std::function<SE3(double)>& motion, const TrackBatch& reported) {
  std::map<TrackId, Vector3> directions;
  std::vector<double> result;
  for (const TrackObservation& z : reported.observations) {
    const Eigen::Quaterniond R = motion(z.t).q;
    const auto [found, fresh] = directions.try_emplace(z.track, R * source.camera().pinhole.ray(z.pixel));
    if (!fresh) result.push_back((source.camera().project(R.conjugate() * found->second) - z.pixel).norm());
  }
  std::ranges::sort(result);
  return result;
}

}  // namespace

TEST_CASE("Points move with the rotation that is registered, also where it reverses", "[slow]") {
  const ReportedMotion reported = follow_motion(motion_scene());
  INFO(reported.remarks.at(0) << "; " << reported.remarks.at(1));
  const std::vector<double> all = errors(motion_scene(), to_and_fro, reported.all);
  REQUIRE(all.size() > 500);
  CHECK(all[all.size() / 2] < 1.0);
  CHECK(all[all.size() * 95 / 100] < 4.0);  // of 400 px of motion, of which a track sees a part
  CHECK(reported.remarks.at(1).find(" 0 times all ended") != std::string::npos);
}

TEST_CASE("A batch within which the motion reverses is divided, and is as accurate as its parts", "[slow]") {
  MotionTracksOptions options;
  options.batch.duration = 0.06;
  const ReportedMotion reported = follow_motion(motion_scene(), options);
  INFO(reported.remarks.at(0) << "; " << reported.remarks.at(1));
  CHECK(reported.remarks.at(0).find(" 0 divided") == std::string::npos);
  const std::vector<double> all = errors(motion_scene(), to_and_fro, reported.all);
  REQUIRE(all.size() > 500);
  CHECK(all[all.size() / 2] < 1.0);
  CHECK(reported.remarks.at(1).find(" 0 times all ended") != std::string::npos);
}

TEST_CASE("Points do not depend on how often they are polled", "[slow]") {
  const TrackBatch usual = follow_motion(motion_scene()).all;
  CHECK(usual.observations.size() > 500);
  CHECK(same(usual, follow_motion(motion_scene(), {}, 0.037).all));
  CHECK(same(usual, follow_motion(motion_scene(), {}, 0.01, 7).all));
}

TEST_CASE("Points of a stationary camera stay at their positions, and go on when it moves", "[slow]") {
  const auto motion = [](double t) {
    return to_and_fro(t < 0.3927 ? t : std::max(0.3927, t - 0.5));
  };  // stationary where it reverses
  const EventScene source(motion, 1.2, EventScene::quadrangles(150, 1));
  const TrackBatch all = follow_motion(source).all;
  std::map<TrackId, std::pair<double, double>> lives;
  for (const TrackObservation& z : all.observations) {
    lives.try_emplace(z.track, z.t, z.t).first->second.second = z.t;
  }
  CHECK(std::ranges::count_if(
            lives, [](const auto& life) { return life.second.first < 0.35 && life.second.second > 0.95; }) > 10);
  std::map<TrackId, Vector2> at_rest;
  for (const TrackObservation& z : all.observations) {
    if (z.t < 0.45 || z.t > 0.85) continue;
    CHECK((at_rest.try_emplace(z.track, z.pixel).first->second - z.pixel).norm() < 0.01);
  }
  CHECK(at_rest.size() > 10);
  const std::vector<double> off = errors(source, motion, all);
  CHECK(off[off.size() / 2] < 2.0);
}

TEST_CASE("Where no motion is registered for too long, all points end, and others begin after it", "[slow]") {
  EventScene flickering = motion_scene();
  Random random(1);
  std::vector<Event> noise;
  for (int i = 0; i < 300'000; ++i) {
    noise.push_back({300'000 + static_cast<std::int64_t>(random.index(400'000)),
                     static_cast<std::uint16_t>(random.index(240)), static_cast<std::uint16_t>(random.index(180)),
                     random.index(2) == 1});
  }
  std::erase_if(flickering.list, [](const Event& e) { return e.t >= 300'000 && e.t < 700'000; });
  flickering.add(noise);
  MotionTracksOptions strict;
  strict.patience = 0.1;
  const ReportedMotion reported = follow_motion(flickering, strict);
  INFO(reported.remarks.at(0) << "; " << reported.remarks.at(1));
  CHECK(reported.remarks.at(1).find("1 times all ended") != std::string::npos);
  std::map<TrackId, std::pair<double, double>> lives;
  for (const TrackObservation& z : reported.all.observations) {
    lives.try_emplace(z.track, z.t, z.t).first->second.second = z.t;
  }
  CHECK(std::ranges::none_of(lives,
                             [](const auto& life) { return life.second.first < 0.4 && life.second.second > 0.6; }));
  CHECK(std::ranges::any_of(lives, [](const auto& life) { return life.second.first > 0.7; }));
}

TEST_CASE("A structure that moves on its own does not disturb the points of str_motion", "[slow]") {
  EventScene source = motion_scene();
  const EventScene other(
      [](double t) {
        return SE3{Eigen::Quaterniond::Identity(), {1.0 - 2.0 * t, 0.3 * t, 0.0}};
      },
      1.0, EventScene::quadrangles(24, 2, 0.15));
  source.add(other.list);
  CHECK(other.list.size() > source.list.size() / 20);
  const ReportedMotion reported = follow_motion(source);
  INFO(reported.remarks.at(0) << "; " << reported.remarks.at(1));
  const std::vector<double> all = errors(source, to_and_fro, reported.all);
  REQUIRE(all.size() > 500);
  CHECK(all[all.size() / 2] < 2.0);  // of 400 px of motion, with one event in twenty of something else
  CHECK(all[all.size() * 95 / 100] < 6.0);
}

TEST_CASE("Without events str_motion publishes nothing, and a source that has none is refused with a sentence") {
  const ReportedMotion none = follow_motion(EventScene(to_and_fro, 0.3, {}));
  CHECK(none.all.until == 0.3);
  class Nothing : public EventScene {
   public:
    Nothing() : EventScene(to_and_fro, 0.01, {}) {}
    std::unique_ptr<EventReader> all_events() const override { return nullptr; }
  };
  CHECK_THROWS_WITH(MotionTracks({}, {Nothing(), 0, ""}),
                    Catch::Matchers::ContainsSubstring("str_motion works on events"));
}
