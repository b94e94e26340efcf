#include "frontends/str/str.hpp"

#include <map>
#include <set>

#include "core/geometry/so3.hpp"
#include "core/testing/catch2.hpp"
#include "core/testing/collect_tracks.hpp"
#include "core/testing/data.hpp"
#include "core/testing/event_scene.hpp"
#include "core/testing/seeds.hpp"
#include "frontends/str/expected_motion.hpp"

using namespace evbench;
using namespace evbench::str;
using evbench::testing::collect_tracks;
using evbench::testing::EventScene;
using evbench::testing::same;
using evbench::testing::swing;
using evbench::testing::track_errors;

namespace {

/// Faster than hand-held motion.
SE3 brisk(double t) { return swing(3.0 * t); }

const EventScene& scene() {
  static const EventScene result(brisk, 0.6, EventScene::quadrangles(150, 1));
  return result;
}

struct Tracked {
  TrackBatch all;
  std::vector<std::string> remarks;
};

/// All observations that it publishes when polled every `interval` [s].
Tracked track(const Source& source, const Options& options = {}, double interval = 0.01, std::size_t most = 0) {
  Str str(options, {source, 0, ""});
  return {collect_tracks(str, source, interval, most), str.remarks()};
}

/// The median of these errors [px].
double median_error(const EventScene& source, const std::function<SE3(double)>& motion,
                    const std::vector<TrackObservation>& observations) {
  const std::vector<double> errors = track_errors(source, motion, observations);
  return errors[errors.size() / 2];
}

/// The share of the observations with a larger error than this [px].
double share_off(const EventScene& source, const std::function<SE3(double)>& motion,
                 const std::vector<TrackObservation>& observations, double pixels) {
  const std::vector<double> errors = track_errors(source, motion, observations);
  const auto off = errors.end() - std::ranges::upper_bound(errors, pixels);
  return static_cast<double>(off) / static_cast<double>(errors.size());
}

std::size_t track_count(const TrackBatch& batch) {
  std::set<TrackId> ids;
  for (const TrackObservation& z : batch.observations) ids.insert(z.track);
  return ids.size();
}

}  // namespace

TEST_CASE("Points of a wall are tracked from batch to batch, each observed at an event's time") {
  const TrackBatch all = track(scene()).all;
  CHECK(track_count(all) > 60);
  CHECK(all.observations.size() > 900);
  CHECK(median_error(scene(), brisk, all.observations) < 0.5);
  CHECK(std::ranges::is_sorted(all.observations, {}, &TrackObservation::t));
  std::map<TrackId, double> last;
  std::set<double> times;
  for (const TrackObservation& z : all.observations) {
    if (last.contains(z.track)) CHECK(z.t > last.at(z.track));
    last[z.track] = z.t;
    times.insert(z.t);
  }
  CHECK(times.size() > all.observations.size() / 2);  // each its own
}

TEST_CASE("A chain of batches drifts, and an anchored track does not", "[slow]") {
  Options chained;
  chained.patch.anchor_fit = 1.0;
  const double anchored = median_error(scene(), brisk, track(scene()).all.observations);
  CHECK(anchored < 0.3);
  CHECK(median_error(scene(), brisk, track(scene(), chained).all.observations) > 1.5 * anchored);
}

TEST_CASE("Tracks of str do not depend on how often they are polled, with batches by duration and by count", "[slow]") {
  Options by_count;
  by_count.batch.events = 15'000;
  for (const Options& options : {Options(), by_count}) {
    const TrackBatch usual = track(scene(), options).all;
    CHECK(usual.observations.size() > 500);
    CHECK(same(usual, track(scene(), options, 0.037).all));
    CHECK(same(usual, track(scene(), options, 0.01, 7).all));
  }
}

TEST_CASE("Batches by count are shorter where there are more events") {
  Options by_count;
  by_count.batch.events = 2000;
  by_count.batch.duration = 0.2;
  by_count.batch.motion = 0.0;
  Batches batches(by_count.batch, 0.25, 0);
  batches.add(scene().list);
  std::size_t count = 0;
  std::int64_t before = 0;
  while (const auto batch = batches.next(600'000)) {
    CHECK((batch->events.size() >= 2000 || batch->to - batch->from >= 199'999));
    if (count > 0) CHECK(batch->from < before);  // the last slice of the one before
    before = batch->to;
    ++count;
  }
  CHECK(count > scene().list.size() / 2000);
}

TEST_CASE("Tracks of a stationary camera go on when it moves", "[slow]") {
  const auto motion = [](double t) { return brisk(t < 0.4 ? t : std::max(0.4, t - 0.6)); };
  const EventScene source(motion, 1.4, EventScene::quadrangles(150, 1));
  const TrackBatch all = track(source).all;
  std::map<TrackId, std::pair<double, double>> lives;
  for (const TrackObservation& z : all.observations) {
    const auto life = lives.try_emplace(z.track, z.t, z.t).first;
    life->second.second = z.t;
  }
  CHECK(std::ranges::count_if(
            lives, [](const auto& life) { return life.second.first < 0.4 && life.second.second > 1.2; }) > 10);
}

TEST_CASE("Under fast motion that reverses, with few or many edges, tracks are right or there are none", "[slow]") {
  const auto motion = [](double t) {
    return SE3{so3::exp({0.0, 0.5 * std::sin(6.0 * t), 0.1 * std::sin(6.0 * t)}), Vector3::Zero()};
  };
  const int edges = GENERATE(30, 150);
  CAPTURE(edges);
  const EventScene source(motion, 0.6, EventScene::quadrangles(edges, 1));  // reverses at 0.26 s
  const Tracked reported = track(source);
  INFO(reported.remarks.at(0) << "; " << reported.remarks.at(1));
  CHECK(track_count(reported.all) > 40);
  CHECK(median_error(source, motion, reported.all.observations) < 1.0);
  CHECK(share_off(source, motion, reported.all.observations, 3.0) < 0.05);
  CHECK(reported.remarks.at(0).find(" 0 poor") == std::string::npos);  // the first batch: 60 px of motion that changes
}

TEST_CASE("A structure that moves on its own does not disturb the other tracks", "[slow]") {
  EventScene source = scene();
  const EventScene other(
      [](double t) {
        return SE3{Eigen::Quaterniond::Identity(), {1.0 - 2.0 * t, 0.3 * t, 0.0}};
      },
      0.6, EventScene::quadrangles(12, 2, 0.15));
  source.add(other.list);
  CHECK(other.list.size() > source.list.size() / 20);
  const TrackBatch all = track(source).all;
  CHECK(track_count(all) > 60);
  CHECK(median_error(source, brisk, all.observations) < 0.5);
  CHECK(share_off(source, brisk, all.observations, 2.0) < 0.05);
}

TEST_CASE("Events that stop, flicker or come all at once neither break nor block str", "[slow]") {
  EventScene silent = scene();
  silent.silence(0.2, 0.4);
  CHECK(track(silent).remarks.at(0).find(" 0 with too few events") == std::string::npos);

  EventScene flickering = scene();
  Random random(1);
  std::vector<Event> more;
  for (int i = 0; i < 100'000; ++i) {
    more.push_back({static_cast<std::int64_t>(random.index(600'000)), static_cast<std::uint16_t>(2 * random.index(120)),
                    static_cast<std::uint16_t>(random.index(180)), random.index(2) == 1});
  }
  flickering.add(more);
  CHECK(track(flickering).all.until == 0.6);

  EventScene burst = scene();
  for (Event& event : more) event.t = 300'000 + event.t / 100;
  burst.add(more);
  Options by_count;
  by_count.batch.events = 1000;
  CHECK(track(burst, by_count).all.until == 0.6);

  const EventScene nothing(brisk, 0.5, {});
  const Tracked none = track(nothing);
  CHECK(none.all.observations.empty());
  CHECK(none.all.until == 0.5);
}

TEST_CASE("A motion that the back-end expects is that of its landmarks") {
  Feedback feedback;
  feedback.state = TrackingState::tracking;
  const Vector3 omega(0.3, -0.2, 0.5), v(0.1, 0.2, -0.3);
  feedback.newest = ControlState{1.0, SE3(), (Vector6() << omega, v).finished()};
  CHECK_FALSE(expected_motion(feedback, MotionModel::planar_4));
  Random random(1);
  for (int i = 0; i < 40; ++i) {
    const double depth = 2.0;
    const Vector2 ray = random.uniform2({-0.5, -0.5}, {0.5, 0.5});
    feedback.expected.push_back({i, depth * Vector3(ray.x(), ray.y(), 1.0), {}, {}});
  }
  const auto eight = expected_motion(feedback, MotionModel::planar_8);
  REQUIRE(eight);
  Matrix3 truth = so3::hat(omega);
  truth.col(2) += v / 2.0;
  const MotionParameters error =
      project_onto(MotionModel::planar_8, *eight) - project_onto(MotionModel::planar_8, truth);
  CHECK(error.norm() < 1e-9);
  feedback.state = TrackingState::lost;
  CHECK_FALSE(expected_motion(feedback, MotionModel::planar_8));
}

TEST_CASE("A source without events is refused by str, with a sentence") {
  class Nothing : public EventScene {
   public:
    Nothing() : EventScene(swing, 0.01, {}) {}
    std::unique_ptr<EventReader> all_events() const override { return nullptr; }
  };
  CHECK_THROWS_WITH(Str({}, {Nothing(), 0, ""}), Catch::Matchers::ContainsSubstring("str works on events"));
}

TEST_CASE("With seeds, tracks begin at the given points and times with the given ids, and no others") {
  const evbench::testing::TemporaryFolder folder;
  const evbench::testing::SeedFile seeds(track(scene()).all);
  Options options;
  options.seeds = folder.write("seeds.txt", seeds.text());
  const TrackBatch all = track(scene(), options).all;
  seeds.check(all);
  CHECK(median_error(scene(), brisk, all.observations) < 1.0);
}
