#pragma once

#include <array>
#include <optional>
#include <vector>

#include "core/geometry/se3.hpp"
#include "core/simulation/rendering/texture.hpp"

namespace evbench {

/// A thing with the scene's texture on it.
struct Surface {
  enum class Kind {
    plane,  ///< z = 0 of its frame, without end
    box,    ///< seen from outside
    room,   ///< a box seen from inside
  };
  Kind kind = Kind::plane;
  SE3 T_world_surface;
  Vector3 half = Vector3::Zero();  ///< of the edges [m]; of a plane: where it is seen
  /// What to add to a place on a face [m] for the place in the texture. Face 2a + 1 is the box's face at +half[a] of
  /// axis a, 2a that at −half[a], and coordinates on a face are those along axes a + 1 and a + 2 (modulo 3). A plane
  /// is face 4.
  std::array<Vector2, 6> offsets{Vector2::Zero(), Vector2::Zero(), Vector2::Zero(),
                                 Vector2::Zero(), Vector2::Zero(), Vector2::Zero()};
};

/// What a ray meets first.
struct Hit {
  int surface = -1, face = 0;
  double depth = 0.0;  ///< along the camera's z [m]

  bool same_face(const Hit& other) const { return surface == other.surface && face == other.face; }
};

/// Surfaces as a camera sees them from one place: rays and hits in the camera's frame.
class View {
 public:
  View(const std::vector<Surface>& surfaces, const SE3& T_world_camera);

  /// The nearest surface on a ray (x, y, 1); none where it leaves the scene.
  std::optional<Hit> hit(const Vector3& ray) const;

  /// Where on the texture a hit is, and how it moves with the ray's x and y.
  struct Place {
    Vector2 texture;
    Matrix2 jacobian;
  };
  Place place(const Hit& hit, const Vector3& ray) const;

 private:
  struct Seen {
    const Surface* surface;
    Matrix3 R;              ///< camera to surface
    Vector3 eye;            ///< camera in the surface's frame
    Vector3 centre;         ///< of the surface in the camera's frame
    double tangent_square;  ///< |centre|² − radius² of the sphere around a box
  };
  static std::optional<Hit> meet(const Seen& seen, const Vector3& ray);

  std::vector<Seen> seen_;
};

}  // namespace evbench
