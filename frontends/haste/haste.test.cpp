#include "frontends/haste/haste.hpp"

#include <algorithm>
#include <map>

#include "core/support/error.hpp"
#include "core/testing/catch2.hpp"
#include "core/testing/collect_tracks.hpp"
#include "core/testing/data.hpp"
#include "core/testing/event_scene.hpp"
#include "core/testing/seeds.hpp"

using namespace evbench;
using namespace evbench::haste;
using evbench::testing::collect_tracks;
using evbench::testing::EventScene;
using evbench::testing::same;
using evbench::testing::swing;
using evbench::testing::track_errors;

namespace {

const EventScene& scene() {
  static const EventScene result(swing, 1.5, EventScene::quadrangles(150, 1));
  return result;
}

/// All observations that it publishes when polled every `interval` [s].
TrackBatch track(const Source& source, const Options& options = {}, double interval = 0.01, std::size_t most = 0) {
  Haste haste(options, {source, 0, ""});
  return collect_tracks(haste, source, interval, most);
}

/// Median distance of the observations from where they should be [px].
double median_error(const EventScene& source, const std::vector<TrackObservation>& observations) {
  const std::vector<double> errors = track_errors(source, swing, observations);
  return errors.at(errors.size() / 2);
}

}  // namespace

TEST_CASE("Points of a wall are tracked as the camera moves, more accurately between states than at the new ones") {
  const TrackBatch refined = track(scene());
  std::map<TrackId, int> tracks;
  for (const TrackObservation& z : refined.observations) ++tracks[z.track];
  CHECK(tracks.size() > 40);
  CHECK(refined.observations.size() > 2000);
  const double error = median_error(scene(), refined.observations);
  CHECK(error < 0.8);
  Options leading;
  leading.place = Options::Place::new_state;
  CHECK(median_error(scene(), track(scene(), leading).observations) > error);
}

TEST_CASE("Tracks do not depend on how often they are polled", "[slow]") {
  const TrackBatch usual = track(scene());
  CHECK(same(usual, track(scene(), {}, 0.037)));
  CHECK(same(usual, track(scene(), {}, 0.01, 7)));
}

TEST_CASE("Observations come in time order, no later than the delay except for those that are counted", "[slow]") {
  Options prompt;
  prompt.delay = 0.0;
  for (const Options& options : {Options(), prompt}) {
    const TrackBatch all = track(scene(), options);
    CHECK(std::ranges::is_sorted(all.observations, {}, &TrackObservation::t));
    std::map<TrackId, double> last;
    for (const TrackObservation& z : all.observations) {
      if (last.contains(z.track)) CHECK(z.t > last.at(z.track));
      last[z.track] = z.t;
    }
  }
}

TEST_CASE("Features are spread over the image and keep their distance") {
  Haste haste({}, {scene(), 0, ""});
  TrackBatch batch;
  haste.advance({0.3}, batch);
  std::map<TrackId, Vector2> first;
  for (const TrackObservation& z : batch.observations) first.emplace(z.track, z.pixel);
  REQUIRE(first.size() > 20);
  int left = 0, top = 0;
  for (const auto& [id, pixel] : first) {
    left += pixel.x() < 120.0;
    top += pixel.y() < 90.0;
  }
  const auto count = static_cast<int>(first.size());
  CHECK(left > count / 4);
  CHECK(left < 3 * count / 4);
  CHECK(top > count / 4);
  CHECK(top < 3 * count / 4);
}

TEST_CASE("Tracks of a stationary camera do not starve, and go on when it moves", "[slow]") {
  const auto motion = [](double t) { return swing(t < 0.5 ? t : std::max(0.5, t - 3.0)); };
  const EventScene source(motion, 4.5, EventScene::quadrangles(150, 1));
  const TrackBatch all = track(source);
  std::map<TrackId, std::pair<double, double>> lives;
  for (const TrackObservation& z : all.observations) {
    const auto life = lives.try_emplace(z.track, z.t, z.t).first;
    life->second.second = z.t;
  }
  const auto go_on = std::ranges::count_if(
      lives, [](const auto& life) { return life.second.first < 0.5 && life.second.second > 3.7; });
  CHECK(go_on > 20);
}

TEST_CASE("A tracker without events starves when the others move") {
  EventScene source(swing, 1.5, EventScene::quadrangles(150, 1));
  std::erase_if(source.list, [](const Event& event) { return event.t > 700'000 && event.x < 80; });
  Haste haste({}, {source, 0, ""});
  TrackBatch batch;
  std::size_t ended = 0;
  for (int k = 1; k <= 150; ++k) {
    haste.advance({0.01 * k}, batch);
    ended += batch.ended.size();
  }
  const std::vector<std::string> remarks = haste.remarks();
  CHECK(ended > 0);
  CHECK_THAT(remarks.at(1), !Catch::Matchers::ContainsSubstring(" 0 starved"));
}

TEST_CASE("A recording without events in the time range is refused with the time of its first one") {
  EventScene source(swing, 1.0, EventScene::quadrangles(20, 1));
  for (Event& event : source.list) event.t += 10'000'000;
  source.cut_off();
  Haste haste({}, {source, 0, "", "c.json: frontend"});
  TrackBatch batch;
  CHECK_THROWS_WITH(haste.advance({1.0}, batch),
                    Catch::Matchers::ContainsSubstring("c.json: frontend: the recording has no events from 0 to 1 s") &&
                        Catch::Matchers::ContainsSubstring("its first one is at 10."));
}

TEST_CASE("Events that are left out are counted in the remarks") {
  EventScene source(swing, 0.5, EventScene::quadrangles(20, 1));
  source.list[100].x = 240;
  source.list[200].t = 0;
  Haste haste({}, {source, 0, ""});
  TrackBatch batch;
  haste.advance({0.5}, batch);
  const std::vector<std::string> remarks = haste.remarks();
  const auto has = [&](const char* text) {
    return std::ranges::any_of(remarks, [&](const std::string& line) { return line.find(text) != std::string::npos; });
  };
  CHECK(has("left out: 1 events outside the sensor"));
  CHECK(has("left out: 1 events out of the order of time"));
}

TEST_CASE("Borders that leave nothing of the image are refused") {
  const EventScene source(swing, 0.1, {});
  Options detecting, living;
  detecting.detection.border = 90.0;
  living.life.border = 90.0;
  CHECK_THROWS_WITH(
      Haste(detecting, {source, 0, "", "frontend"}),
      Catch::Matchers::ContainsSubstring("frontend.detection.border: 90 px leave nothing of an image of 240 x 180"));
  CHECK_THROWS_WITH(Haste(living, {source, 0, "", "frontend"}),
                    Catch::Matchers::ContainsSubstring("frontend.life.border: 90 px"));
}

TEST_CASE("A source without events is refused with a sentence") {
  class Nothing : public EventScene {
   public:
    Nothing() : EventScene(swing, 0.01, {}) {}
    std::unique_ptr<EventReader> all_events() const override { return nullptr; }
  };
  CHECK_THROWS_WITH(Haste({}, {Nothing(), 0, ""}), Catch::Matchers::ContainsSubstring("event_simulation"));
}

TEST_CASE("With seeds, tracks begin at the given points and times with the given ids, and no others") {
  const evbench::testing::TemporaryFolder folder;
  const evbench::testing::SeedFile seeds(track(scene()));
  Options options;
  options.seeds = folder.write("seeds.txt", seeds.text());
  const TrackBatch all = track(scene(), options);
  seeds.check(all);
  CHECK(median_error(scene(), all.observations) < 1.0);
}
