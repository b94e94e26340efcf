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

TEST_CASE("Observations with larger noise have larger errors") {
  Options options;
  options.score_covariance = true;
  std::map<TrackId, Vector3> points;
  std::vector<double> usual, sharp, vague;
  std::vector<double> sigmas;
  for (const TrackObservation& z : observations(options)) {
    CHECK(z.noise.sigma() >= 0.499 * options.sigma);
    CHECK(z.noise.sigma() <= 3.001 * options.sigma);
    sigmas.push_back(z.noise.sigma());
    const SE3 T = swing(z.t);
    if (const auto point = points.find(z.track); point != points.end()) {
      const double error = (sigma_scene().camera().project(T.inverse() * point->second) - z.pixel).norm();
      const double share = z.noise.sigma() / options.sigma;
      (share < 0.8 ? sharp : share > 1.25 ? vague : usual).push_back(error);
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

TEST_CASE("All observations have the same noise where scores are not used") {
  Options options;
  options.score_covariance = false;
  const auto all = observations(options);
  CHECK_FALSE(all.empty());
  CHECK(std::ranges::all_of(all, [&](const TrackObservation& z) { return z.noise == options.sigma; }));
}
