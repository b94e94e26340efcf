#include "bench/render/track_overlay.hpp"

#include <set>

#include "core/testing/catch2.hpp"

using namespace evbench;

namespace {

constexpr int kScale = 4;

/// The enlarged picture's pixel at the centre of a sensor pixel.
Colour at(const Picture& picture, int x, int y) { return picture(kScale * y + kScale / 2, kScale * x + kScale / 2); }

Picture drawn(double t) {
  const TrackOverlay overlay({{7, 1.00, {10, 10}}, {8, 1.02, {30, 5}}, {7, 1.05, {20, 10}}, {7, 1.08, {30, 10}}}, 0.1);
  Picture picture(kScale * 20, kScale * 40, light_palette().background);
  overlay.draw(t, kScale, light_palette(), picture);
  return picture;
}

}  // namespace

TEST_CASE("A track is drawn as a dot in its colour at its newest position, with a tail that fades") {
  const Palette palette = light_palette();
  const Picture picture = drawn(1.06);
  CHECK(at(picture, 20, 10) == track_colour(7, palette));
  CHECK(at(picture, 30, 5) == track_colour(8, palette));
  CHECK(at(picture, 14, 10) != palette.background);  // the tail
  CHECK(at(picture, 25, 10) == palette.background);  // still to come
  CHECK(cv::norm(at(picture, 14, 10), palette.background) > 50);
  CHECK(at(drawn(1.14), 25, 10) != at(drawn(1.08), 25, 10));  // older, fainter
}

TEST_CASE("A track that ended longer ago than a tail is not drawn") {
  const Picture picture = drawn(1.19);
  CHECK(cv::countNonZero(picture.reshape(1) != 255) == 0);
}

TEST_CASE("Tracks of other ids have other colours, never the events' red or blue") {
  for (const Palette& palette : {light_palette(), dark_palette()}) {
    std::set<std::tuple<int, int, int>> colours;
    for (TrackId id = -5; id < 15; ++id) {
      const Colour colour = track_colour(id, palette);
      colours.insert({colour[0], colour[1], colour[2]});
      CHECK(cv::norm(colour, palette.on) > 80);
      CHECK(cv::norm(colour, palette.off) > 60);
    }
    CHECK(colours.size() == 20);
  }
}

TEST_CASE("Positions far outside the picture do no harm") {
  const TrackOverlay overlay({{1, 0.0, {-1e9, 1e300}}, {1, 0.01, {1e12, 5}}}, 0.1);
  Picture picture(20, 20, light_palette().background);
  overlay.draw(0.02, 1, light_palette(), picture);
  CHECK(picture.rows == 20);
}
