#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/geometry/camera.hpp"
#include "core/simulation/rendering/view.hpp"

namespace evbench {

/// A rendered image; all fields by rows.
struct Frame {
  std::vector<float> log_intensity;
  std::vector<Hit> hits;           ///< of the pixels' centres; surface −1 where there is nothing
  std::vector<std::uint8_t> edge;  ///< does a neighbour see another face?
};

/// Renders log intensity by casting rays through a camera with lens. A pixel's intensity is averaged with a Gaussian of
/// standard deviation `blur` [px] (a pixel's area and the optics): by a sample of the blurred texture (several in a
/// line where it is foreshortened), or, where a neighbour sees another face, by 32 rays. The image therefore changes
/// smoothly as the camera moves.
class Renderer {
 public:
  /// Keeps pointers to `surfaces` and `texture`. Surfaces without end have the texture everywhere.
  Renderer(const Camera& camera, const std::vector<Surface>& surfaces, const Texture& texture, double blur);

  const Camera& camera() const { return camera_; }
  View view(const SE3& T_world_camera) const { return {*surfaces_, T_world_camera}; }

  /// `threads`: 0: one per processor.
  void render(const SE3& T_world_camera, int threads, Frame& frame) const;

  /// One pixel of an image; `edge` as in Frame.
  float pixel(const View& view, std::size_t index, bool edge) const;

  /// x and y of the ray (x, y, 1) of a pixel's centre; NaN where the lens model has no inverse: such a pixel sees
  /// nothing.
  const Vector2& ray(std::size_t index) const { return rays_[index]; }

 private:
  static constexpr std::size_t kEdgeRays = 32;

  void add_ray(const Vector2& pixel);
  float intensity(const View& view, const Hit& hit, std::size_t index) const;
  float row_of_samples(const Vector2& centre, const Matrix2& covariance, double longer, double shorter) const;
  float intensity_at_edge(const View& view, std::size_t index) const;
  void mark_edges(int y, const std::vector<std::uint8_t>& even, Frame& frame) const;

  Camera camera_;
  const std::vector<Surface>* surfaces_;
  const Texture* texture_;
  double blur_;
  std::vector<Vector2> rays_;               ///< of the pixels' centres, undistorted
  std::vector<Eigen::Matrix2f> jacobians_;  ///< of the rays by the pixel
  std::array<Vector2, kEdgeRays> spread_;   ///< offsets of the rays at an edge [px]
};

}  // namespace evbench
