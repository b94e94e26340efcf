#include "eval/track_scores.hpp"

#include <algorithm>
#include <vector>

#include "core/support/json.hpp"
#include "core/testing/catch2.hpp"

using namespace evbench;

namespace {

/// Points move to the right at 100 px/s; x 0 to 240. A point's z is its x at time 0.
class Belt : public PointTruth {
 public:
  std::optional<Vector3> point(const Vector2& pixel, double t) const override {
    return Vector3(0.0, pixel.y(), pixel.x() - 100.0 * t);
  }
  std::optional<Vector2> pixel(const Vector3& point, double t) const override {
    const Vector2 pixel(point.z() + 100.0 * t, point.y());
    const bool hidden = point.y() > 90.0 && t > 0.05 && t < 0.8;
    return pixel.x() > 240.0 || hidden ? std::nullopt : std::optional(pixel);
  }
};

void add(std::vector<TrackObservation>& all, TrackId id, double from, double to, double drift) {
  for (double t = from; t < to + 1e-9; t += 0.02) {
    all.push_back({id, t, {10.0 + 100.0 * (t - from), 50.0 + drift * (t - from)}});
  }
}

}  // namespace

TEST_CASE("Tracks are scored against the points where they begin") {
  std::vector<TrackObservation> all;
  add(all, 1, 0.0, 1.2, 0.0);   // exact
  add(all, 2, 0.0, 1.2, 10.0);  // off by 1 px at 0.1 s, 5 at 0.5 s, 10 at 1 s
  add(all, 3, 0.0, 0.2, 0.0);   // short
  std::ranges::stable_sort(all, {}, &TrackObservation::t);
  const std::vector<TrackEnd> ends{{3, 0.2}};
  const Json scores = score_tracks(all, ends, Belt(), 1.5);
  CHECK(scores.at("pieces") == 3);
  CHECK(scores.at("life_s").at("median").get<double>() == Approx(1.2));
  CHECK(scores.at("alive").at("after_500ms").get<double>() == Approx(2.0 / 3.0));
  CHECK(scores.at("error_px").at("at_100ms").at("median").get<double>() == Approx(0.0).margin(1e-9));
  CHECK(scores.at("error_px").at("at_500ms").at("median").get<double>() == Approx(2.5).margin(0.2));
  CHECK(scores.at("error_px").at("at_1s").at("p90").get<double>() == Approx(9.0).margin(0.3));
  CHECK(scores.at("drifting").get<double>() == Approx(1.0 / 3.0));
  CHECK(scores.at("beyond_3px").get<double>() == Approx(45.0 / 130.0).margin(0.02));
  CHECK(scores.at("reassociated").at("right") == 0);
}

TEST_CASE("A track that goes on after its end is right within 3 px of its first point's true track") {
  std::vector<TrackObservation> all;
  for (const TrackId id : {1, 2}) add(all, id, 0.0, 0.3, 0.0);
  std::ranges::stable_sort(all, {}, &TrackObservation::t);
  const std::vector<TrackEnd> ends{{1, 0.3}, {2, 0.3}};
  all.push_back({1, 0.8, {92.0, 50.0}});  // truth: 90
  all.push_back({2, 0.8, {97.0, 50.0}});
  const Json scores = score_tracks(all, ends, Belt(), 1.0);
  CHECK(scores.at("reassociated").at("right") == 1);
  CHECK(scores.at("reassociated").at("wrong") == 1);
  CHECK(scores.at("pieces") == 4);
}

TEST_CASE("Observations of hidden points do not count, and an age has no error from long after it") {
  std::vector<TrackObservation> all;
  for (double t = 0.0; t < 1.2; t += 0.02) {
    all.push_back({1, t, {10.0 + 100.0 * t, 100.0 + (t > 0.05 && t < 0.8 ? 50.0 : 0.0)}});
  }
  const Json scores = score_tracks(all, {}, Belt(), 1.5);
  CHECK(scores.at("beyond_3px") == 0.0);
  CHECK(scores.at("error_px").at("at_100ms").at("median").is_null());
  CHECK(scores.at("error_px").at("at_500ms").at("median").is_null());
  CHECK(scores.at("error_px").at("at_1s").at("median").get<double>() == Approx(0.0).margin(1e-9));
}

TEST_CASE("Without tracks there are no values") {
  const Json scores = score_tracks({}, {}, Belt(), 1.0);
  CHECK(scores.at("pieces") == 0);
  CHECK(scores.at("life_s").at("median").is_null());
  CHECK(scores.at("drifting").is_null());
}
