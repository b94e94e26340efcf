#include "core/simulation/rendering/renderer.hpp"

#include <tbb/global_control.h>

#include <cmath>
#include <limits>

#include "core/simulation/random.hpp"
#include "core/testing/catch2.hpp"

using namespace evbench;

namespace {

Camera camera(DistortionModel model = DistortionModel::none) {
  Camera camera;
  camera.pinhole = {100.0, 100.0, 39.5, 29.5};
  camera.width = 80;
  camera.height = 60;
  camera.distortion = model;
  if (model == DistortionModel::radial_tangential) camera.coefficients << -0.35, 0.15, 0.0, 0.0, 0.0;
  return camera;
}

/// Black left of the middle, white right of it; 4 m wide.
Texture edge_texture() {
  cv::Mat picture(2048, 2048, CV_8U, cv::Scalar(0));
  picture.colRange(1024, 2048).setTo(255);
  return {picture, {4.0, 4.0}, 0.01};
}

Texture checkers(int square) {
  cv::Mat picture(1024, 1024, CV_8U);
  for (int y = 0; y < picture.rows; ++y) {
    for (int x = 0; x < picture.cols; ++x)
      picture.at<std::uint8_t>(y, x) = (x / square + y / square) % 2 == 0 ? 0 : 255;
  }
  return {picture, {4.0, 4.0}, 0.01};
}

/// The plane z = 2 with the texture's middle at x = y = 0.
std::vector<Surface> wall() {
  Surface surface;
  surface.T_world_surface.p = {0.0, 0.0, 2.0};
  surface.offsets[4] = {2.0, 2.0};
  return {surface};
}

std::size_t index(int x, int y) { return static_cast<std::size_t>(80 * y + x); }

}  // namespace

TEST_CASE("An edge is where the geometry says, blurred by the pixel's Gaussian") {
  const double blur = GENERATE(0.4, 1.0);
  const auto surfaces = wall();
  const Texture texture = edge_texture();
  const Renderer renderer(camera(), surfaces, texture, {.blur = blur});
  Frame frame;
  for (double x = -0.01; x < 0.01; x += 0.0007) {  // half a pixel to either side
    renderer.render({Eigen::Quaterniond::Identity(), {x, 0.0, 0.0}}, 1, frame);
    const double edge = 39.5 - 50.0 * x;
    for (int column = 30; column < 50; ++column) {
      const double expected = 0.01 + 0.99 * 0.5 * std::erfc(-(column - edge) / (blur * M_SQRT2));
      REQUIRE(std::abs(std::exp(frame.log_intensity[index(column, 20)]) - expected) < 0.05);
    }
  }
}

TEST_CASE("An edge is seen through the lens") {
  const auto surfaces = wall();
  const Texture texture = edge_texture();
  const Camera bent = camera(DistortionModel::radial_tangential);
  const Renderer renderer(bent, surfaces, texture, Optics{});
  Frame frame;
  const double x = -0.6;
  renderer.render({Eigen::Quaterniond::Identity(), {x, 0.0, 0.0}}, 1, frame);
  for (int row = 5; row < 55; row += 7) {
    int column = 40;  // first bright pixel of the row
    while (column < 79 && std::exp(frame.log_intensity[index(column, row)]) < 0.5) ++column;
    double y = (row - 29.5) / 100.0 * 2.0;  // of the edge's point in that row, by iteration
    for (int i = 0; i < 50; ++i) y += (row - bent.project({-x, y, 2.0}).y()) * 0.01;
    CHECK(std::abs(bent.project({-x, y, 2.0}).x() - (column - 0.5)) < 0.6);
  }
}

TEST_CASE("A pattern that is much finer than the pixels is an even grey, however the camera moves") {
  const auto surfaces = wall();
  const Texture texture = checkers(1);  // 0.2 px
  const Renderer renderer(camera(), surfaces, texture, Optics{});
  Frame frame;
  for (double x = 0.0; x < 0.05; x += 0.004) {
    renderer.render({Eigen::Quaterniond(Eigen::AngleAxisd(x, Vector3::UnitZ())), {x, 0.3 * x, x}}, 1, frame);
    for (const float L : frame.log_intensity) REQUIRE(std::abs(L - std::log(texture.mean())) < 0.02);
  }
}

TEST_CASE("A texture averaged over all of its surface is its mean") {
  const Texture texture = checkers(64);
  for (const float variance : {1e6F, 1e38F, std::numeric_limits<float>::infinity()}) {
    CHECK(texture.sample(0.3, 0.7, variance) == texture.mean());
  }
}

TEST_CASE("The nearest surface hides others, and a room is seen from inside") {
  Surface box{Surface::Kind::box, {Eigen::Quaterniond::Identity(), {0.2, 0.0, 1.5}}, {0.1, 0.1, 0.1}};
  Surface room{Surface::Kind::room, {}, {3.0, 3.0, 3.0}};
  const Texture texture = checkers(64);
  const std::vector<Surface> surfaces{room, box};
  const Renderer renderer(camera(), surfaces, texture, Optics{});
  Frame frame;
  renderer.render({}, 1, frame);
  const double column = 39.5 + 100.0 * 0.2 / 1.4;
  const Hit& hit = frame.hits[index(static_cast<int>(column), 29)];
  CHECK(hit.surface == 1);
  CHECK(hit.face == 4);  // towards the camera: at −z
  CHECK(hit.depth == Approx(1.4));
  CHECK(frame.hits[index(10, 29)].surface == 0);
  CHECK(frame.hits[index(10, 29)].depth == Approx(3.0));
  CHECK(frame.edge[index(10, 29)] == 0);
  const int left = static_cast<int>(std::ceil(39.5 + 100.0 * 0.1 / 1.4));  // the first pixel of the box
  CHECK(frame.edge[index(left, 29)] == 1);
  CHECK(frame.edge[index(left - 1, 29)] == 1);
}

TEST_CASE("The outline of a box before a wall is blurred as the geometry says, also at its corners") {
  cv::Mat dark(8, 8, CV_8U, cv::Scalar(0)), halves(2048, 2048, CV_8U, cv::Scalar(255));
  halves.colRange(0, 1024).setTo(0);
  const Texture texture(halves, {40.0, 40.0}, 0.01);
  Surface box{Surface::Kind::box,
              {Eigen::Quaterniond(Eigen::AngleAxisd(0.3, Vector3::UnitZ())), {0.0, 0.0, 1.5}},
              {0.1, 0.1, 0.1}};
  for (Vector2& offset : box.offsets) offset = {5.0, 5.0};  // black
  Surface back;
  back.T_world_surface.p = {0.0, 0.0, 2.0};
  back.offsets[4] = {30.0, 30.0};  // white
  const std::vector<Surface> surfaces{back, box};
  const double blur = 0.45;
  const Renderer renderer(camera(), surfaces, texture, {.blur = blur});
  Frame frame;
  double at_edges = 0.0, at_corners = 0.0, last = 0.0, jump = 0.0;
  for (double x = -0.02; x < 0.02; x += 0.0002) {
    renderer.render({Eigen::Quaterniond::Identity(), {x, 0.0, 0.0}}, 1, frame);
    const double scale = 100.0 / 1.4;  // px/m on the box's front
    for (int row = 15; row < 45; ++row) {
      for (int column = 25; column < 55; ++column) {
        // The share of the Gaussian outside the turned square, which is wide against it.
        const Vector2 local = Eigen::Rotation2Dd(-0.3) * Vector2((column - 39.5) / scale + x, (row - 29.5) / scale);
        const auto inside = [&](double at) {
          return 0.5 *
                 (std::erf((0.1 + at) * scale / (blur * M_SQRT2)) + std::erf((0.1 - at) * scale / (blur * M_SQRT2)));
        };
        const double expected = 1.0 - 0.99 * inside(local.x()) * inside(local.y());
        const double error = std::abs(std::exp(frame.log_intensity[index(column, row)]) - expected);
        const bool corner = (local.cwiseAbs() - Vector2(0.1, 0.1)).cwiseAbs().maxCoeff() < 2.0 / scale;
        double& worst = corner ? at_corners : at_edges;
        worst = std::max(worst, error);
      }
    }
    const double now = std::exp(frame.log_intensity[index(48, 30)]);  // an edge passes it
    if (x > -0.02) jump = std::max(jump, std::abs(now - last));
    last = now;
  }
  CHECK(at_edges < 0.02);
  CHECK(at_corners < 0.1);  // a line that cuts a corner, or 32 rays
  CHECK(jump < 0.02);       // in steps of 0.014 px
}

TEST_CASE("A picture that follows another one is that which would be without it") {
  Random random(5);
  std::vector<Surface> surfaces;
  for (int i = 0; i < 20; ++i) {
    const Vector3 axis = random.normal3().normalized();
    surfaces.push_back({Surface::Kind::box,
                        {Eigen::Quaterniond(Eigen::AngleAxisd(random.uniform(0.0, 3.0), axis)),
                         random.uniform3({-0.8, -0.6, 1.0}, {0.8, 0.6, 2.5})},
                        random.uniform3({0.05, 0.05, 0.05}, {0.2, 0.2, 0.2})});
  }
  surfaces.push_back({Surface::Kind::room, {}, {3.0, 3.0, 3.0}});
  const Texture texture = checkers(32);
  const Renderer renderer(camera(), surfaces, texture, Optics{}, {.gradient = {0.3, 0.1, 0.0}, .limit = 1.0});
  Frame before, after, alone;
  renderer.render({}, 1, before);
  std::size_t differences = 0;
  for (int i = 1; i < 100; ++i) {  // up to 0.5 px each
    const SE3 T{Eigen::Quaterniond(Eigen::AngleAxisd(0.003 * i, Vector3(1.0, 1.0, 1.0).normalized())),
                {0.003 * i, -0.001 * i, 0.002 * i}};
    renderer.render_next(T, 1, before, after);
    renderer.render(T, 1, alone);
    for (std::size_t k = 0; k < alone.hits.size(); ++k) differences += after.hits[k].same_face(alone.hits[k]) ? 0 : 1;
    std::swap(before, after);
  }
  CHECK(differences <= 5);  // of half a million: corners of less than a pixel that come into view
}

TEST_CASE("A single pixel is the picture's, and threads do not change the picture") {
  const tbb::global_control four(tbb::global_control::max_allowed_parallelism, 4);
  const auto surfaces = wall();
  const Texture texture = checkers(32);
  const Renderer renderer(camera(), surfaces, texture, Optics{});
  const SE3 T{Eigen::Quaterniond(Eigen::AngleAxisd(0.4, Vector3(0.3, 1.0, 0.1).normalized())), {0.1, 0.2, 0.3}};
  Frame one, two;
  renderer.render(T, 1, one);
  renderer.render(T, 3, two);
  CHECK(one.log_intensity == two.log_intensity);
  const View view = renderer.view(T);
  for (std::size_t i = 0; i < one.log_intensity.size(); i += 7) {
    REQUIRE(renderer.pixel(view, i, one, one) == one.log_intensity[i]);
  }
}

TEST_CASE("The Jacobian of a place on the texture equals differences, on planes and boxes") {
  Surface tilted;
  tilted.T_world_surface = {Eigen::Quaterniond(Eigen::AngleAxisd(0.5, Vector3(1.0, 2.0, 0.5).normalized())),
                            {0.0, 0.0, 2.0}};
  const Surface box{Surface::Kind::box, tilted.T_world_surface, {0.5, 0.4, 0.3}};
  Random random(3);
  for (const std::vector<Surface>& surfaces : {std::vector<Surface>{tilted}, std::vector<Surface>{box}}) {
    const View view(surfaces, {});
    for (int i = 0; i < 100; ++i) {
      const Vector2 ray = random.uniform2({-0.1, -0.1}, {0.1, 0.1});
      const Hit hit = view.hit(ray);
      REQUIRE(hit.surface >= 0);
      const View::Face face = view.face(hit);
      const View::Face::Place place = face.at(ray.x(), ray.y());
      CHECK(place.depth == Approx(hit.depth));
      const Vector2 by_axis[] = {{place.ux, place.vx}, {place.uy, place.vy}};
      for (Eigen::Index axis = 0; axis < 2; ++axis) {
        const Vector2 moved = ray + 1e-6 * Vector2::Unit(axis);
        const Hit other = view.hit(moved);
        if (other.surface < 0 || other.face != hit.face) continue;
        const View::Face::Place next = face.at(moved.x(), moved.y());
        const Vector2 difference = Vector2(next.u - place.u, next.v - place.v) / 1e-6;
        REQUIRE((difference - by_axis[axis]).norm() < 1e-4);
      }
    }
  }
}
