#include <algorithm>
#include <functional>
#include <map>
#include <string>

#include "core/testing/catch2.hpp"
#include "core/testing/event_scene.hpp"
#include "frontends/haste/haste.hpp"
#include "frontends/haste/tracking/testing/event_patterns.hpp"

// Why and when tracks end, as seen by the receiver of the observations.
using namespace evbench;
using namespace evbench::haste;
using evbench::haste::testing::EventPattern;
using evbench::haste::testing::PatternPose;
using evbench::testing::EventScene;
using evbench::testing::swing;

namespace {

const EventScene& life_scene() {
  static const EventScene result(swing, 1.0, EventScene::quadrangles(150, 1));
  return result;
}

/// A front-end, and the observations that it has published so far.
struct Followed {
  Haste haste;
  TrackBatch batch = {};
  double t = 0.0;                                  ///< [s]
  std::map<TrackId, TrackObservation> alive = {};  ///< newest observations
  std::map<TrackId, TrackObservation> ended = {};  ///< likewise
  std::map<TrackId, double> ended_at = {};         ///< [s]

  Followed(const Options& options, const Source& source) : haste(options, {source, 0, ""}) {}

  void go_on_to(double to) {
    while (t < to - 1e-9) {
      t = std::min(to, t + 0.01);
      haste.advance({t}, batch);
      for (const TrackObservation& z : batch.observations) {
        INFO("track " << z.track << " at " << z.t << " s");
        CHECK_FALSE((ended_at.contains(z.track) && z.t > ended_at.at(z.track)));
        alive[z.track] = z;
      }
      for (const TrackEnd& end : batch.ended) {
        ended_at[end.track] = end.t;
        if (const auto track = alive.find(end.track); track != alive.end()) ended.insert(alive.extract(track));
      }
    }
  }

  /// How many trackers ended for a reason, in the remark's words.
  int ended_as(const std::string& words) const {
    const std::string line = haste.remarks().at(1);
    const std::size_t end = line.find(' ' + words);
    REQUIRE(end != std::string::npos);
    return std::stoi(line.substr(line.rfind(' ', end - 1)));
  }
};

/// The feedback of a back-end that knows the truth at t [s]: a landmark for each of these observations, where it is
/// seen.
Feedback truth(double t, const std::vector<TrackObservation>& observed) {
  Feedback feedback;
  feedback.t = t;
  feedback.state = TrackingState::tracking;
  constexpr double kShortStep = 1e-3;
  const Vector6 velocity = se3::log(swing(t).inverse() * swing(t + kShortStep)) / kShortStep;
  feedback.newest = ControlState{t, swing(t), velocity};
  for (const TrackObservation& z : observed) {
    const SE3 T = swing(z.t);
    const Vector3 ray = T.R() * life_scene().camera().pinhole.ray(z.pixel);
    feedback.expected.push_back(
        {z.track, T.p + (EventScene::kDistance - T.p.z()) / ray.z() * ray, z.pixel, 0.25 * Matrix2::Identity()});
  }
  return feedback;
}

/// Eight tracks at 0.5 s, which without feedback go on after it.
std::vector<TrackObservation> eight() {
  Followed reported({}, life_scene());
  reported.go_on_to(0.5);
  std::map<TrackId, TrackObservation> alive = reported.alive;
  reported.go_on_to(0.65);
  std::vector<TrackObservation> result;
  for (const auto& [id, z] : alive) {
    if (result.size() < 8 && reported.alive.contains(id)) result.push_back(z);
  }
  REQUIRE(result.size() == 8);
  return result;
}

/// Moves a landmark by so much in the image [px].
void shift(ExpectedFeature& feature, const Vector2& by) {
  feature.position += swing(0.5).R() * Vector3(by.x(), by.y(), 0.0) * EventScene::kDistance / 200.0;
}

constexpr const char* kVetoed = "far from where they were expected";

/// A square of 8 px that moves over the image, and nothing else.
std::vector<Event> square(const std::function<Vector2(double)>& place, std::uint64_t seed) {
  EventPattern pattern;
  pattern.lines = {{{-4, -4}, {4, -4}}, {{4, -4}, {4, 4}}, {{4, 4}, {-4, 4}}, {{-4, 4}, {-4, -4}}};
  pattern.pose = [=](double t) { return PatternPose{place(t), 0.0}; };
  pattern.rate = 60e3;
  pattern.noise = 0.0;
  return pattern.events(1.5, seed);
}

}  // namespace

TEST_CASE("A track that the back-end rejects as an outlier ends and is not observed any more") {
  Followed reported({}, life_scene());
  reported.go_on_to(0.5);
  const TrackId outlier = eight()[3].track;
  Feedback feedback = truth(0.5, {});
  feedback.outliers = {outlier, 4711};
  reported.haste.receive(feedback);
  reported.go_on_to(0.6);
  REQUIRE(reported.ended_at.contains(outlier));
  CHECK(reported.ended_at.at(outlier) == Approx(0.5).margin(1e-6));
  reported.go_on_to(1.0);
  CHECK_FALSE(reported.alive.contains(outlier));
  CHECK(reported.ended_as("as outliers") == 1);

  Options deaf;
  deaf.guidance.outliers = false;
  Followed other(deaf, life_scene());
  other.go_on_to(0.5);
  other.haste.receive(feedback);
  other.go_on_to(0.6);
  CHECK(other.ended_as("as outliers") == 0);
}

TEST_CASE("A tracker far from its landmark's expected position is vetoed, unless most are and the expectation is wrong",
          "[slow]") {
  for (const int far : {0, 1, 8}) {
    Followed reported({}, life_scene());
    reported.go_on_to(0.5);
    const std::vector<TrackObservation> observed = eight();
    Feedback feedback = truth(0.5, observed);
    for (int i = 0; i < far; ++i) {  // in directions that no camera motion explains
      shift(feedback.expected[static_cast<std::size_t>(i)], {i % 2 == 0 ? 20.0 : -20.0, i % 4 < 2 ? 20.0 : -20.0});
    }
    reported.haste.receive(feedback);
    reported.go_on_to(0.55);
    CAPTURE(far);
    CHECK(reported.ended_as(kVetoed) == (far == 1 ? 1 : 0));
    CHECK(reported.ended_at.contains(observed.front().track) == (far == 1));
  }
}

TEST_CASE("Nothing is vetoed where that is switched off or the back-end has lost tracking") {
  for (const bool lost : {false, true}) {
    Options options;
    options.guidance.veto = lost;
    Followed reported(options, life_scene());
    reported.go_on_to(0.5);
    Feedback feedback = truth(0.5, eight());
    shift(feedback.expected.front(), {20.0, 20.0});
    if (lost) feedback.state = TrackingState::lost;
    reported.haste.receive(feedback);
    reported.go_on_to(0.55);
    CHECK(reported.ended_as(kVetoed) == 0);
  }
}

TEST_CASE("Few trackers that step to and fro under noise and fast motion are taken for erratic ones", "[slow]") {
  constexpr double kNoise = 6e6;  // [events/s]
  const auto fast = [](double t) { return swing(6.0 * t); };
  EventScene source(fast, 0.6, EventScene::quadrangles(150, 1));
  Random random(5);
  std::vector<Event> noise(static_cast<std::size_t>(kNoise * 0.6));
  for (std::size_t i = 0; i < noise.size(); ++i) {
    noise[i] = {static_cast<std::int64_t>(1e6 * static_cast<double>(i) / kNoise),
                static_cast<std::uint16_t>(random.index(240)), static_cast<std::uint16_t>(random.index(180)),
                i % 2 == 0};
  }
  source.add(noise);
  Followed reported({}, source);
  reported.go_on_to(0.6);
  CHECK(reported.alive.size() > 40);
  CHECK(reported.ended.size() > 100);
  CHECK(10 * reported.ended_as("erratic") < std::ssize(reported.ended));
}

TEST_CASE("Trackers that a burst of noise displaces end, without observations at the displaced positions") {
  EventScene source(swing, 1.0, EventScene::quadrangles(150, 1));
  Random random(3);
  std::vector<Event> burst(300'000);
  for (std::size_t i = 0; i < burst.size(); ++i) {
    burst[i] = {502'000 + static_cast<std::int64_t>(i / 100), static_cast<std::uint16_t>(random.index(240)),
                static_cast<std::uint16_t>(random.index(180)), i % 2 == 0};
  }
  source.add(burst);
  Followed reported({}, source);
  reported.go_on_to(0.5);
  const std::map<TrackId, TrackObservation> before = reported.alive;
  REQUIRE(before.size() > 40);
  reported.go_on_to(0.55);
  CHECK(reported.ended_as("erratic") > 40);
  for (const auto& [track, last] : reported.ended) {
    if (!before.contains(track)) continue;
    CAPTURE(track, last.t);
    CHECK((last.pixel - before.at(track).pixel).norm() < 15.0);
  }
  reported.go_on_to(1.0);
  CHECK(reported.alive.size() > 40);
}

TEST_CASE("After a silence trackers go on where they see the same pattern, and end where they see another", "[slow]") {
  const auto standing = [](double t) { return swing(t < 0.5 ? t : std::max(0.5, t - 0.5)); };
  const EventScene still(standing, 1.3, EventScene::quadrangles(150, 1));
  const auto shifting = [](double t) {  // by 50 px during the silence
    SE3 T = swing(t);
    T.p.x() += 0.5 * std::max(0.0, t - 0.5);
    return T;
  };
  EventScene moved(shifting, 2.0, EventScene::quadrangles(150, 1));
  moved.silence(0.5, 1.5);
  struct After {
    double alive;  ///< share of the tracks from before
    int ended;
  };
  const auto after = [](const Source& source, double resting, double later) {
    Followed reported({}, source);
    reported.go_on_to(resting);
    const std::map<TrackId, TrackObservation> before = reported.alive;
    REQUIRE(before.size() > 40);
    reported.go_on_to(later);
    const auto alive =
        std::ranges::count_if(before, [&](const auto& track) { return reported.alive.contains(track.first); });
    return After{static_cast<double>(alive) / static_cast<double>(before.size()),
                 reported.ended_as("mismatched after a silence")};
  };
  const After same = after(still, 0.9, 1.1), different = after(moved, 1.4, 2.0);
  CHECK(same.alive > 0.5);
  CHECK(same.ended <= 3);
  CHECK(different.alive < 0.2);
  CHECK(different.ended > 15);
}

TEST_CASE("Without events no new feature is found", "[slow]") {
  EventScene quiet(swing, 2.2, EventScene::quadrangles(150, 1));
  quiet.silence(1.0, 2.0);
  Options options;
  options.life.curvature = 0.9;  // trackers end as soon as they run, so that features are always needed
  Followed reported(options, quiet);
  const auto detected = [&] { return std::stoi(reported.haste.remarks().at(0)); };
  reported.go_on_to(1.05);
  const int before = detected();
  reported.go_on_to(1.95);
  CHECK(detected() == before);
  reported.go_on_to(2.2);
  CHECK(detected() > before);
}

TEST_CASE("A tracker on a hot pixel ends, as it does not move with the image") {
  EventScene source(swing, 1.0, EventScene::quadrangles(150, 1));
  std::erase_if(source.list, [](const Event& event) { return event.x < 80; });
  std::vector<Event> hot;
  for (std::int64_t t = 0; t < 1'000'000; t += 500) hot.push_back({t, 40, 90, true});
  source.add(hot);
  Followed reported({}, source);
  reported.go_on_to(1.0);
  CHECK(reported.ended_as("starved") > 0);
}

TEST_CASE("Of two trackers that meet the newer one ends") {
  EventScene source(swing, 1.5, {});
  const auto from = [](double x, double t) { return Vector2(120.0 + x * std::max(0.0, 1.0 - t / 0.9), 90.0); };
  source.add(square([&](double t) { return from(-25.0, t); }, 1));
  source.add(square([&](double t) { return from(25.0, t); }, 2));
  Options options;
  options.tracks = 2;
  Followed reported(options, source);
  reported.go_on_to(0.4);
  REQUIRE(reported.alive.size() == 2);
  const TrackId older = reported.alive.begin()->first, younger = reported.alive.rbegin()->first;
  CHECK((reported.alive.at(older).pixel - reported.alive.at(younger).pixel).norm() > 15.0);
  reported.go_on_to(1.2);
  CHECK(reported.ended_as("crowded") >= 1);
  CHECK(reported.ended_at.contains(younger));
  CHECK_FALSE(reported.ended_at.contains(older));
}

TEST_CASE("A tracker near the image's border ends") {
  EventScene source(swing, 1.5, {});
  source.add(square([](double t) { return Vector2(120.0 + 110.0 * t, 90.0); }, 1));
  Options options;
  options.tracks = 1;
  Followed reported(options, source);
  reported.go_on_to(0.5);
  REQUIRE(reported.alive.size() == 1);
  const TrackId track = reported.alive.begin()->first;
  reported.go_on_to(1.3);
  REQUIRE(reported.ended.contains(track));
  CHECK(reported.ended_as("at the border") >= 1);
  CHECK(reported.ended.at(track).pixel.x() > 239.0 - options.life.border - 6.0);
  CHECK(reported.ended.at(track).pixel.x() < 239.0);
}
