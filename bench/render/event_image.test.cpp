#include "bench/render/event_image.hpp"

#include "bench/render/time_surface.hpp"
#include "core/testing/catch2.hpp"

using namespace evbench;

namespace {

const std::vector<Event> kEvents{{1000, 1, 0, true}, {2000, 2, 1, true}, {3000, 2, 1, false}};

}  // namespace

TEST_CASE("A pixel has the colour of its newest event, or the background's") {
  for (const Palette& palette : {light_palette(), dark_palette()}) {
    const Picture picture = draw_events(kEvents, {4, 3}, palette);
    CHECK(picture.size() == cv::Size(4, 3));
    CHECK(picture(0, 1) == palette.on);
    CHECK(picture(1, 2) == palette.off);
    CHECK(picture(2, 3) == palette.background);
  }
}

TEST_CASE("Brighter is red and darker is blue, on white or almost black") {
  for (const Palette& palette : {light_palette(), dark_palette()}) {
    CHECK(palette.on[2] > palette.on[0] + 100);
    CHECK(palette.off[0] > palette.off[2] + 100);
  }
  CHECK(light_palette().background == Colour(255, 255, 255));
  CHECK(cv::norm(cv::Vec3i(dark_palette().background)) < 50);
}

TEST_CASE("A time surface decays exponentially from a pixel's newest event, with its sign") {
  const cv::Mat1f surface = time_surface(kEvents, {4, 3}, 5000, 2000.0);
  CHECK(surface(0, 1) == Approx(std::exp(-2.0)));
  CHECK(surface(1, 2) == Approx(-std::exp(-1.0)));
  CHECK(surface(2, 3) == 0.0F);
  const Palette palette = light_palette();
  const Picture picture = draw_time_surface(surface, palette);
  CHECK(picture(2, 3) == palette.background);
  CHECK(picture(1, 2) == blend(palette.background, palette.off, std::exp(-1.0)));
}

TEST_CASE("Colours blend from one to the other") {
  const Colour a(0, 100, 255), b(200, 100, 5);
  CHECK(blend(a, b, 0.0) == a);
  CHECK(blend(a, b, 1.0) == b);
  CHECK(blend(a, b, 0.5) == Colour(100, 100, 130));
}
