#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/geometry/camera.hpp"
#include "core/simulation/rendering/light.hpp"
#include "core/simulation/rendering/view.hpp"

namespace evbench {

/// A rendered image; all fields by rows.
struct Frame {
  std::vector<float> log_intensity;
  std::vector<Hit> hits;  ///< of the pixels' centres; surface −1 where there is nothing. Depths are old where no
                          ///< search was needed
  std::vector<std::uint8_t> edge;  ///< does a neighbour see another face?
};

/// What a camera does to the light: a Gaussian average over a pixel's area and by the optics, and the share of the
/// light that is lost at the image's corners, with the square of the distance from the middle.
struct Optics {
  double blur = 0.45;  ///< standard deviation [px]
  double vignetting = 0.0;
};

/// Renders log intensity by casting rays through a camera with lens. A pixel's intensity is averaged with a Gaussian of
/// standard deviation `blur` [px]: by a sample of the blurred texture (several in a line where it is foreshortened).
/// Where a neighbour sees another face, the two faces' samples are weighted by the share of the Gaussian on either side
/// of the line between them, or, where that is no line, by a share of 32 rays. The image therefore changes smoothly as
/// the camera moves.
class Renderer {
 public:
  /// Keeps pointers to `surfaces` and `texture`. Surfaces without end have the texture everywhere.
  Renderer(const Camera& camera, const std::vector<Surface>& surfaces, const Texture& texture, const Optics& optics,
           const Light& light = {});

  const Camera& camera() const { return camera_; }
  View view(const SE3& T_world_camera) const { return {*surfaces_, T_world_camera}; }

  /// `threads`: 0: one per processor.
  void render(const SE3& T_world_camera, int threads, Frame& frame) const;

  /// The same if nothing has moved by more than a pixel since the frame `before`: faces are searched at its edges and
  /// at the image's border alone.
  void render_next(const SE3& T_world_camera, int threads, const Frame& before, Frame& frame) const;

  /// One pixel of an image from between two frames, from one to the other of which nothing moves by more than a pixel.
  float pixel(const View& view, std::size_t index, const Frame& before, const Frame& after) const;

  /// x and y of the ray (x, y, 1) of a pixel's centre; NaN where the lens model has no inverse: such a pixel sees
  /// nothing.
  const Vector2& ray(std::size_t index) const { return rays_[index]; }

 private:
  static constexpr std::size_t kEdgeRays = 32;

  /// A pixel and those around it, as far as they are in the image.
  struct Neighbours {
    std::size_t count = 0;
    std::array<std::size_t, 9> pixels;
    std::array<Vector2, 9> rays;
  };
  void add_ray(const Vector2& pixel);
  Neighbours neighbours(std::size_t index) const;
  void shade(const View& view, const Hit& hit, std::size_t first, std::size_t count, float* log_intensity) const;
  float row_of_samples(const Vector2& centre, float xx, float xy, float yy, float longer, float shorter) const;
  float edge(const View& view, std::size_t index, const Neighbours& around, std::span<const Hit> hits) const;
  float corner(const View& view, std::size_t index) const;
  void search_row(const View& view, int y, const Frame& before, Frame& frame) const;
  void shade_row(const View& view, int y, Frame& frame) const;
  void mark_edges(int y, const std::vector<std::uint8_t>& even, Frame& frame) const;

  Camera camera_;
  const std::vector<Surface>* surfaces_;
  const Texture* texture_;
  double blur_;
  Light light_;
  std::vector<float> vignetting_;           ///< logarithm of the share of light that pixels get; empty: all of it
  std::vector<Vector2> rays_;               ///< of the pixels' centres, undistorted
  std::vector<Eigen::Matrix2f> jacobians_;  ///< of the rays by the pixel
  std::array<Vector2, kEdgeRays> spread_;   ///< offsets of the rays at an edge [px]
};

}  // namespace evbench
