#include "frontends/poisson/poisson.hpp"

#include <algorithm>
#include <map>
#include <set>

#include "core/testing/catch2.hpp"
#include "core/testing/collect_tracks.hpp"
#include "core/testing/data.hpp"
#include "core/testing/event_scene.hpp"
#include "core/testing/seeds.hpp"

using namespace evbench;
using namespace evbench::poisson;
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
  Poisson poisson(options, {source, 0, ""});
  return collect_tracks(poisson, source, interval, most);
}

/// Median distance of the observations from where they should be [px].
double median_error(const EventScene& source, const std::vector<TrackObservation>& observations) {
  const std::vector<double> errors = track_errors(source, swing, observations);
  return errors.at(errors.size() / 2);
}

}  // namespace

TEST_CASE("Points of a wall are tracked as the camera moves, with a sigma of each observation") {
  const TrackBatch tracks = track(scene());
  std::map<TrackId, int> lengths;
  std::set<double> sigmas;
  for (const TrackObservation& z : tracks.observations) {
    ++lengths[z.track];
    sigmas.insert(z.noise.sigma());
  }
  CHECK(lengths.size() > 40);
  CHECK(tracks.observations.size() > 1000);
  CHECK(sigmas.size() > 100);
  CHECK(median_error(scene(), tracks.observations) < 1.0);
}

TEST_CASE("Observations have covariances, unless that is switched off") {
  const auto directed = [](const TrackBatch& tracks) {
    return std::ranges::count_if(tracks.observations,
                                 [](const TrackObservation& z) { return !z.noise.is_isotropic(); });
  };
  Options isotropic;
  isotropic.covariance = false;
  CHECK(directed(track(scene())) > 1000);
  CHECK(directed(track(scene(), isotropic)) == 0);
}

TEST_CASE("Tracks do not depend on how often they are polled, nor on threads", "[slow]") {
  const TrackBatch usual = track(scene());
  Options threaded;
  threaded.threads = 3;
  CHECK(same(usual, track(scene(), threaded)));
  CHECK(same(usual, track(scene(), {}, 0.037)));
  CHECK(same(usual, track(scene(), {}, 0.01, 7)));
}

TEST_CASE("Tracks end at the border, and as outliers") {
  Poisson poisson({}, {scene(), 0, ""});
  TrackBatch batch;
  poisson.advance({0.5}, batch);
  REQUIRE(!batch.observations.empty());
  Feedback feedback;
  feedback.outliers = {batch.observations.back().track};
  poisson.receive(feedback);
  std::vector<TrackEnd> ended;
  std::size_t observed = 0;
  for (int k = 51; k <= 150; ++k) {
    poisson.advance({0.01 * k}, batch);
    ended.insert(ended.end(), batch.ended.begin(), batch.ended.end());
    for (const TrackObservation& z : batch.observations) {
      CHECK(scene().camera().contains(z.pixel, Options().life.border - 3.0));
    }
    observed += batch.observations.size();
  }
  CHECK(observed > 500);
  CHECK(std::ranges::count(ended, feedback.outliers[0], &TrackEnd::track) == 1);
  CHECK_THAT(poisson.remarks().at(1), Catch::Matchers::ContainsSubstring(" 1 as outliers"));
  CHECK_THAT(poisson.remarks().at(1), !Catch::Matchers::ContainsSubstring(" 0 at the border"));
}

TEST_CASE("Tracks of a stationary camera wait, and go on when it moves", "[slow]") {
  const auto motion = [](double t) { return swing(t < 0.5 ? t : std::max(0.5, t - 1.0)); };
  const EventScene source(motion, 2.0, EventScene::quadrangles(150, 1));
  std::map<TrackId, std::pair<double, double>> lives;
  for (const TrackObservation& z : track(source).observations) {
    lives.try_emplace(z.track, z.t, z.t).first->second.second = z.t;
  }
  const auto go_on = std::ranges::count_if(
      lives, [](const auto& life) { return life.second.first < 0.5 && life.second.second > 1.7; });
  CHECK(go_on > 10);
}

TEST_CASE("Borders that leave nothing of the image are refused") {
  const EventScene source(swing, 0.1, {});
  Options detecting, living;
  detecting.detection.border = 90.0;
  living.life.border = 90.0;
  CHECK_THROWS_WITH(Poisson(detecting, {source, 0, "", "frontend"}),
                    Catch::Matchers::ContainsSubstring("frontend.detection.border: 90 px"));
  CHECK_THROWS_WITH(Poisson(living, {source, 0, "", "frontend"}),
                    Catch::Matchers::ContainsSubstring("frontend.life.border: 90 px"));
}

TEST_CASE("With seeds, tracks begin at the given points and times with the given ids, and no others") {
  const evbench::testing::TemporaryFolder folder;
  const evbench::testing::SeedFile seeds(track(scene()));
  Options options;
  options.seeds = folder.write("seeds.txt", seeds.text());
  options.settling = 0;
  const TrackBatch all = track(scene(), options);
  seeds.check(all);
  CHECK(median_error(scene(), all.observations) < 1.2);
}
