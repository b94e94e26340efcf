#pragma once

#include <memory>
#include <vector>

#include "core/simulation/events/brightness.hpp"
#include "core/simulation/motion.hpp"
#include "core/simulation/rendering/rendered_scene.hpp"
#include "core/simulation/rendering/renderer.hpp"

namespace evbench {

struct RenderingOptions {
  double max_displacement = 0.5;
  Optics optics;

  void declare(OptionSet& set);
};

/// The scene that a camera sees along a motion. An interval is as long as no point of the scene moves by more than
/// max_displacement over the image (tested at every eighth pixel of every eighth row), at most 10 ms.
class SceneBrightness : public Brightness {
 public:
  /// `threads`: 0: one per processor.
  SceneBrightness(const Camera& camera, std::shared_ptr<const RenderedScene> scene, Motion motion,
                  const RenderingOptions& options, int threads);

  int width() const override { return renderer_.camera().width; }
  int height() const override { return renderer_.camera().height; }
  void start(double t) override;
  double advance(double limit) override;
  double displacement() const override { return moved_; }
  std::span<const float> image() const override { return frame_.log_intensity; }
  float within(int x, int y, int part) const override;

 private:
  double displacement_at(const SE3& T_world_camera) const;
  double choose_end(double limit);

  std::shared_ptr<const RenderedScene> scene_;
  Motion motion_;
  RenderingOptions options_;
  int threads_;
  Renderer renderer_;
  double from_ = 0.0, to_ = 0.0;  ///< the interval [s]
  Frame frame_, last_;            ///< at its end and its beginning
  std::vector<View> views_;       ///< at the ends of its parts but the last
  struct Probe {
    Vector2 pixel;  ///< undistorted
    Vector3 point;  ///< world frame
  };
  std::vector<Probe> probes_;  ///< at its end
  double last_length_ = 1e-3;  ///< [s]
  double moved_ = 0.0;         ///< displacement in the interval [px]
};

}  // namespace evbench
