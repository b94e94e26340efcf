#pragma once

#include <string>
#include <vector>

#include "core/geometry/camera.hpp"
#include "core/plugin/options.hpp"
#include "core/simulation/motion.hpp"
#include "core/simulation/random.hpp"
#include "core/simulation/rendering/light.hpp"
#include "core/simulation/rendering/texture.hpp"
#include "core/simulation/rendering/view.hpp"

namespace evbench {

struct RenderedSceneOptions {
  std::string kind = "plane", texture = {};
  double near = 1.0, far = 3.0;
  int boxes = 12;
  double detail = 0.0;
  double black = 0.05, light = 1.0;
  std::string picture = {};
  double picture_width = 1.0;

  void declare(OptionSet& set);
};

/// Surfaces to render, and the picture on them.
struct RenderedScene {
  std::vector<Surface> surfaces;
  Texture texture;
  Light light;
  /// Places on the surfaces that can be tracked (dots' centres, corners), world frame; some may never be visible.
  std::vector<Vector3> features;
};

/// A scene in the camera's view during the motion:
/// - dots: dark dots on a white plane;
/// - shapes: dark geometric shapes on a white plane;
/// - plane: a plane;
/// - boxes: boxes in a room, between the depths near and far from the path.
/// On the surfaces is a picture, or a texture that is drawn (patterns.hpp): leaves, unless the options say another one.
/// Light falls on the scene from one side: along a random direction at right angles to the mean view it changes by the
/// factor `light` over the scene's extent.
/// Planes are at right angles to the mean view direction, half way between near and far.
/// Throws InputError, naming `place`, as check_rendered_scene() does, and for a picture that can't be read (relative to
/// `folder`).
RenderedScene make_rendered_scene(const RenderedSceneOptions& options, const Camera& camera, const Motion& motion,
                                  double duration, Random random, const std::string& folder, const std::string& place);

/// Throws InputError, naming `place`, unless near < far, and if the motion leads to or behind the plane. Needs no
/// picture and takes no time.
void check_rendered_scene(const RenderedSceneOptions& options, const Camera& camera, const Motion& motion,
                          double duration, const std::string& place);

}  // namespace evbench
