#include "core/simulation/rendering/rendered_scene.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>

#include "core/io/path.hpp"
#include "core/simulation/layout.hpp"
#include "core/simulation/rendering/patterns.hpp"
#include "core/support/error.hpp"
#include "core/support/index.hpp"

namespace evbench {
namespace {

constexpr double kLayoutRate = 10.0;  ///< of the poses for the layout of a scene [Hz]

using Box = Eigen::AlignedBox3d;

/// A pattern and its size on the surfaces [m].
struct Print {
  Pattern pattern;
  Vector2 size;
  Vector2 metres(const Vector2& pixel) const {
    return (pixel.array() + 0.5) * size.array() / Eigen::Array2d(pattern.picture.cols, pattern.picture.rows);
  }
};

struct DrawnTexture {
  const char* name;
  Pattern (*draw)(int side, double detail, Random& random);
  double detail;  ///< size in the image [px] of the smallest detail at mean depth, unless the options state it
};
constexpr DrawnTexture kTextures[] = {
    {"leaves", draw_leaves, 5.0},     {"stripes", draw_stripes, 5.0}, {"bare", draw_bare, 5.0},
    {"repeated", draw_repeated, 5.0}, {"dots", draw_dots, 7.0},       {"shapes", draw_shapes, 40.0},
};

const DrawnTexture& texture_of(const RenderedSceneOptions& options) {
  const auto named = [](const std::string& name) {
    return std::ranges::find(kTextures, name, [](const DrawnTexture& texture) { return std::string(texture.name); });
  };
  const auto found = named(options.texture.empty() ? options.kind : options.texture);
  return found != std::end(kTextures) ? *found : kTextures[0];
}

/// A print `width` [m] wide, as far as its texels allow: half a pixel each where the camera is nearest.
Print make_print(const RenderedSceneOptions& options, const Camera& camera, double width, Random& random,
                 const std::string& folder) {
  if (!options.picture.empty()) {
    Print print{read_picture(resolve_path(options.picture, folder)), {}};
    print.size = options.picture_width *
                 Vector2(1.0, static_cast<double>(print.pattern.picture.rows) / print.pattern.picture.cols);
    return print;
  }
  const double depth = 0.5 * (options.near + options.far), pixel = 1.0 / camera.pinhole.fx;
  const DrawnTexture& texture = texture_of(options);
  const double detail = options.detail > 0.0 ? options.detail : texture.detail * depth * pixel;
  const double texel = std::min(0.5 * (options.kind == "boxes" ? options.near : depth) * pixel, detail / 4.0);
  const auto texels = static_cast<unsigned>(std::clamp(width / texel, 512.0, 4096.0));
  const int side = static_cast<int>(std::bit_ceil(texels));
  Pattern pattern = texture.draw(side, detail / texel, random);
  return {std::move(pattern), Vector2::Constant(side * texel)};
}

/// Is the box clear of the path? Boxes that are not are drawn again.
bool clear_of_path(const UprightBox& box, const SceneLayout& layout, double distance) {
  return std::ranges::all_of(layout.path.poses(), [&](const StampedPose& pose) {
    const Vector3 local = box.turn.conjugate() * (layout.frame.inverse() * pose.T.p - box.centre);
    return ((local.cwiseAbs() - box.half).cwiseMax(0.0)).norm() > distance;
  });
}

std::vector<Surface> boxes_in_room(const RenderedSceneOptions& options, const SceneLayout& layout, Random& random) {
  constexpr int kAttempts = 20;
  const Box volume = layout.viewed_volume(options.near, options.far);
  std::vector<Surface> surfaces;
  for (int i = 0; i < options.boxes; ++i) {
    for (int attempt = 0; attempt < kAttempts; ++attempt) {
      const UprightBox box(volume, random);
      if (!clear_of_path(box, layout, 0.5 * options.near)) continue;
      surfaces.push_back({Surface::Kind::box, layout.frame * SE3{box.turn, box.centre}, box.half});
      break;
    }
  }
  Box room = volume;
  for (const StampedPose& pose : layout.path.poses()) room.extend(layout.frame.inverse() * pose.T.p);
  surfaces.push_back({Surface::Kind::room, layout.frame * SE3{Eigen::Quaterniond::Identity(), room.center()},
                      0.5 * room.sizes() + Vector3::Constant(0.3 * options.near)});
  return surfaces;
}

/// A random offset at which the face lies within the print; for a face as large as the print, the print's middle.
Vector2 offset_on_print(const Surface& surface, int face, const Print& print, Random& random) {
  Vector2 offset;
  for (Eigen::Index i = 0; i < 2; ++i) {
    const double half = surface.half[(face / 2 + 1 + i) % 3];
    const double room = surface.kind == Surface::Kind::box ? std::max(0.0, print.size[i] - 2.0 * half) : 0.0;
    offset[i] = 0.5 * print.size[i] + room * (random.uniform() - 0.5);
  }
  return offset;
}

/// Throws InputError where the path comes so near to the plane, or behind it, that nothing is visible.
void check_before_plane(double depth, const SceneLayout& layout, const Motion& motion, double duration,
                        const std::string& place) {
  constexpr double kRate = 50.0, kNearest = 0.02;  // [Hz]; share of the depth
  for (double t = 0.0; t <= duration; t += 1.0 / kRate) {
    const double left = depth - (layout.frame.inverse() * motion(t).p).z();
    if (left > kNearest * depth) continue;
    throw InputError(
        fmt::format("{}: at {:.2f} s the camera is {:.3f} m before the plane, which is {:.3g} m ahead of the motion's "
                    "mean; expected "
                    "larger near and far, or a smaller motion",
                    place, t, left, depth));
  }
}

std::vector<Surface> plane(const RenderedSceneOptions& options, const SceneLayout& layout) {
  const Box rectangle = layout.viewed_rectangle(0.5 * (options.near + options.far));
  return {{Surface::Kind::plane, layout.frame * SE3{Eigen::Quaterniond::Identity(), rectangle.center()},
           0.5 * rectangle.sizes()}};
}

/// The print's features on a face.
void add_features(const Surface& surface, int face, const Print& print, std::vector<Vector3>& features) {
  const Eigen::Index axis = face / 2, right = (axis + 1) % 3, down = (axis + 2) % 3;
  for (const Vector2& pixel : print.pattern.features) {
    const Vector2 place = print.metres(pixel) - surface.offsets[index(face)];
    if (std::abs(place.x()) > surface.half[right] || std::abs(place.y()) > surface.half[down]) continue;
    Vector3 local;
    local[right] = place.x();
    local[down] = place.y();
    local[axis] = face % 2 == 1 ? surface.half[axis] : -surface.half[axis];  // 0 for a plane
    features.push_back(surface.T_world_surface * local);
  }
}

}  // namespace

void RenderedSceneOptions::declare(OptionSet& set) {
  set.add("kind", kind, "scene in view of the camera").choices({"plane", "dots", "shapes", "boxes"});
  set.add("near", near, "smallest depth seen from the path [m]; planes are in the middle").above(0.0);
  set.add("far", far, "largest depth seen from the path [m]").above(0.0);
  set.add("boxes", boxes, "number of boxes").range(0, 1e4);
  set.add("detail", detail, "size of dots, of shapes, of the finest texture [m]; 0: from the camera").range(0.0);
  set.add("black", black, "intensity of black on the surfaces, that of white being 1: the contrast").range(1e-3, 0.99);
  set.add("texture", texture, "what is drawn on the surfaces; empty: leaves, or what the kind says")
      .choices({"", "leaves", "stripes", "bare", "repeated", "dots", "shapes"});
  set.add("light", light, "light on one side of the scene, as a multiple of that on the other; 1: even")
      .range(1e-3, 1e3);
  set.add("picture", picture, "path of a picture to put on the surfaces instead; empty: none").path();
  set.add("picture_width", picture_width, "its width on a surface, after which it is mirrored [m]").above(0.0);
}

RenderedScene make_rendered_scene(const RenderedSceneOptions& options, const Camera& camera, const Motion& motion,
                                  double duration, Random random, const std::string& folder, const std::string& place) {
  check_rendered_scene(options, camera, motion, duration, place);
  const SceneLayout layout(camera, sample_motion(motion, duration, kLayoutRate));
  const bool boxes = options.kind == "boxes";
  std::vector<Surface> surfaces = boxes ? boxes_in_room(options, layout, random) : plane(options, layout);
  const Vector3& largest = surfaces.back().half;
  const Print print = make_print(options, camera, 2.0 * largest.maxCoeff(), random, folder);
  for (Surface& surface : surfaces) {
    for (int face = 0; face < 6; ++face) {
      surface.offsets[index(face)] = offset_on_print(surface, face, print, random);
    }
  }
  RenderedScene scene{std::move(surfaces), Texture(print.pattern.picture, print.size, options.black), {}, {}};
  if (options.light != 1.0) {
    const double angle = random.uniform(0.0, 2.0 * M_PI);
    const Vector3 across = layout.frame.q * Vector3(std::cos(angle), std::sin(angle), 0.0);
    const Surface& extent = scene.surfaces.back();
    scene.light.gradient = std::log(options.light) / (2.0 * extent.half.head<2>().maxCoeff()) * across;
    scene.light.origin = extent.T_world_surface.p;
    scene.light.limit = std::abs(0.5 * std::log(options.light));
  }
  for (const Surface& surface : scene.surfaces) {
    for (int face = 0; face < 6; ++face) {
      if (boxes || face == 4) add_features(surface, face, print, scene.features);
    }
  }
  return scene;
}

void check_rendered_scene(const RenderedSceneOptions& options, const Camera& camera, const Motion& motion,
                          double duration, const std::string& place) {
  if (!(options.near < options.far)) {
    throw InputError(
        fmt::format("{}: near is {} m and far {} m; expected near < far", place, options.near, options.far));
  }
  if (options.kind == "boxes") return;
  const SceneLayout layout(camera, sample_motion(motion, duration, kLayoutRate));
  check_before_plane(0.5 * (options.near + options.far), layout, motion, duration, place);
}

}  // namespace evbench
