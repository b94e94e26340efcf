#include "frontends/str/dots/dots.hpp"

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

constexpr double kRadius = 0.1;  // [m]: 10 px

EventScene::Outline disc(const Vector2& centre) {
  EventScene::Outline result;
  for (int i = 0; i < 48; ++i) {
    const double angle = 2.0 * M_PI * i / 48;
    result.push_back(centre + kRadius * Vector2(std::cos(angle), std::sin(angle)));
  }
  return result;
}

/// All alike, in a regular grid.
std::vector<Vector2> places() {
  std::vector<Vector2> result;
  for (int row = -3; row <= 3; ++row) {
    for (int column = -4; column <= 4; ++column) result.emplace_back(0.4 * column, 0.4 * row);
  }
  return result;
}

std::vector<EventScene::Outline> discs() {
  std::vector<EventScene::Outline> result;
  for (const Vector2& place : places()) result.push_back(disc(place));
  return result;
}

/// To and fro along the wall, with a little rotation.
SE3 sweep(double t) {
  return {so3::exp({0.05 * std::sin(2.0 * t), 0.0, 0.1 * std::sin(1.5 * t)}),
          {0.8 * std::sin(2.5 * t), 0.3 * std::sin(1.7 * t), 0.1 * std::sin(t)}};
}

const EventScene& dots_scene() {
  static const EventScene result(sweep, 2.0, discs());
  return result;
}

struct ReportedDots {
  TrackBatch all;
  std::vector<std::string> remarks;
};

ReportedDots follow_dots(const Source& source, const DotsOptions& options = {}, double interval = 0.01,
                         std::size_t most = 0) {
  Dots dots(options, {source, 0, ""});
  return {collect_tracks(dots, source, interval, most), dots.remarks()};
}

/// The disc nearest to an observation, and the distance from its centre [px].
std::pair<std::size_t, double> nearest_disc(const TrackObservation& z, const std::function<SE3(double)>& motion) {
  const SE3 T_camera_world = motion(z.t).inverse();
  std::pair<std::size_t, double> best{0, 1e9};
  const std::vector<Vector2> all = places();
  for (std::size_t i = 0; i < all.size(); ++i) {
    const Vector2 pixel =
        dots_scene().camera().project(T_camera_world * Vector3(all[i].x(), all[i].y(), EventScene::kDistance));
    if (const double distance = (pixel - z.pixel).norm(); distance < best.second) best = {i, distance};
  }
  return best;
}

}  // namespace

TEST_CASE("The centres of identical dots are observed, and a dot that comes back is recognised", "[slow]") {
  DotsOptions options;
  options.life.find_again = true;
  const ReportedDots reported = follow_dots(dots_scene(), options);
  INFO(reported.remarks.at(0) << "; " << reported.remarks.at(1) << "; " << reported.remarks.at(2));
  REQUIRE(reported.all.observations.size() > 1500);
  CHECK(std::ranges::is_sorted(reported.all.observations, {}, &TrackObservation::t));
  std::vector<double> errors;
  std::map<TrackId, std::size_t> disc_of;
  std::map<std::size_t, TrackId> track_of;
  std::size_t strays = 0;
  for (const TrackObservation& z : reported.all.observations) {
    const auto [i, error] = nearest_disc(z, sweep);
    errors.push_back(error);
    if (disc_of.try_emplace(z.track, i).first->second != i) ++strays;
    track_of.try_emplace(i, z.track);
  }
  std::ranges::sort(errors);
  CHECK(errors[errors.size() / 2] < 0.3);
  CHECK(errors[errors.size() * 95 / 100] < 0.8);
  CHECK(strays == 0);
  CHECK(reported.remarks.at(1).find(" 0 re-acquired") == std::string::npos);
  CHECK(disc_of.size() < track_of.size() + track_of.size() / 5);  // few dots have a second track
}

TEST_CASE("By default a dot that comes back gets a new track, and an ended track is not observed any more", "[slow]") {
  const TrackBatch all = follow_dots(dots_scene()).all;
  std::map<TrackId, double> ended;
  for (const TrackEnd& end : all.ended) CHECK(ended.emplace(end.track, end.t).second);
  for (const TrackObservation& z : all.observations) {
    if (ended.contains(z.track)) CHECK(z.t <= ended.at(z.track));
  }
}

TEST_CASE("Dots do not depend on how often they are polled", "[slow]") {
  const TrackBatch usual = follow_dots(dots_scene()).all;
  CHECK(same(usual, follow_dots(dots_scene(), {}, 0.037).all));
  CHECK(same(usual, follow_dots(dots_scene(), {}, 0.01, 5).all));
}

TEST_CASE("Dots of a stationary camera go on when it moves", "[slow]") {
  const auto motion = [](double t) { return sweep(t < 0.4 ? t : std::max(0.4, t - 0.8)); };
  const EventScene source(motion, 1.8, discs());
  std::map<TrackId, std::pair<double, double>> lives;
  for (const TrackObservation& z : follow_dots(source).all.observations) {
    lives.try_emplace(z.track, z.t, z.t).first->second.second = z.t;
    CHECK(nearest_disc(z, motion).second < 3.0);
  }
  CHECK(std::ranges::count_if(
            lives, [](const auto& life) { return life.second.first < 0.4 && life.second.second > 1.3; }) > 10);
}

TEST_CASE("A dot that moves on its own is tracked and does not disturb the others", "[slow]") {
  EventScene source = dots_scene();
  // A small one that is drawn across the image, over all others.
  const EventScene alone(
      [](double t) {
        return SE3{Eigen::Quaterniond::Identity(), {1.0 - 0.8 * t, 0.05, 0.0}};
      },
      2.6, {disc({0.0, 0.0})});
  source.add(alone.list);
  std::vector<double> errors;
  for (const TrackObservation& z : follow_dots(source).all.observations)
    errors.push_back(nearest_disc(z, sweep).second);
  std::ranges::sort(errors);
  CHECK(errors[errors.size() * 8 / 10] < 0.8);
}

TEST_CASE("Where nothing is round, no observation is published", "[slow]") {
  const EventScene square(sweep, 0.6, EventScene::quadrangles(40, 1, 0.4));
  CHECK(follow_dots(square).all.observations.size() < 200);
  CHECK(follow_dots(EventScene(sweep, 0.3, {})).all.observations.empty());
  EventScene silent = dots_scene();
  silent.silence(0.5, 1.5);
  CHECK(follow_dots(silent).all.until == 2.0);
}
