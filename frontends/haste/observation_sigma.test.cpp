#include <algorithm>
#include <map>

#include "core/support/median.hpp"
#include "core/testing/catch2.hpp"
#include "core/testing/collect_tracks.hpp"
#include "core/testing/event_scene.hpp"
#include "frontends/haste/haste.hpp"

using namespace evbench;
using namespace evbench::haste;
using evbench::testing::collect_tracks;
using evbench::testing::EventScene;
using evbench::testing::swing;

namespace {

const EventScene& sigma_scene() {
  static const EventScene result(swing, 1.0, EventScene::quadrangles(150, 1));
  return result;
}

std::vector<TrackObservation> observations(const Options& options) {
  Haste haste(options, {sigma_scene(), 0, ""});
  return collect_tracks(haste, sigma_scene()).observations;
}

}  // namespace

TEST_CASE("Observations with a larger sigma have larger errors") {
  Options options;
  options.score_sigma = true;
  std::map<TrackId, Vector3> points;
  std::vector<double> usual, sharp, vague;
  std::vector<double> sigmas;
  for (const TrackObservation& z : observations(options)) {
    CHECK(z.noise.sigma() >= 0.5 * options.sigma);
    CHECK(z.noise.sigma() <= 3.0 * options.sigma);
    sigmas.push_back(z.noise.sigma());
    const SE3 T = swing(z.t);
    if (const auto point = points.find(z.track); point != points.end()) {
      const double error = (sigma_scene().camera().project(T.inverse() * point->second) - z.pixel).norm();
      (z.noise.sigma() < 0.8 * options.sigma ? sharp : z.noise.sigma() > 1.25 * options.sigma ? vague : usual).push_back(error);
    } else {
      const Vector3 ray = T.R() * sigma_scene().camera().pinhole.ray(z.pixel);
      points.emplace(z.track, T.p + (EventScene::kDistance - T.p.z()) / ray.z() * ray);
    }
  }
  REQUIRE_FALSE((sigmas.empty() || sharp.empty() || usual.empty() || vague.empty()));
  CHECK(median(sigmas) == Approx(options.sigma).epsilon(0.1));
  CAPTURE(sharp.size(), usual.size(), vague.size(), median(sharp), median(usual), median(vague));
  CHECK(median(vague) > 1.2 * median(usual));
  CHECK(median(vague) > 1.4 * median(sharp));
}

TEST_CASE("All observations have the same sigma where scores are not used") {
  Options options;
  options.score_sigma = false;
  const auto all = observations(options);
  CHECK_FALSE(all.empty());
  CHECK(std::ranges::all_of(all, [&](const TrackObservation& z) { return z.noise.sigma() == options.sigma; }));
}
