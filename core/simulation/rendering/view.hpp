#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "core/geometry/se3.hpp"
#include "core/simulation/rendering/texture.hpp"

namespace evbench {

/// An object with the scene's texture on it.
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

/// What a ray hits first.
struct Hit {
  int surface = -1, face = 0;
  double depth = 0.0;  ///< along the camera's z [m]

  bool same_face(const Hit& other) const { return surface == other.surface && face == other.face; }
};

/// Surfaces as a camera sees them from one place: rays (x, y, 1) and hits in the camera's frame.
class View {
 public:
  View(const std::vector<Surface>& surfaces, const SE3& T_world_camera);

  const SE3& T_world_camera() const { return T_world_camera_; }

  /// The nearest surface on each ray, given by its x and y; surface −1 where it leaves the scene, or is NaN.
  /// Consecutive rays share the search for surfaces near them, so keep them close together.
  void hit(std::span<const Vector2> rays, std::span<Hit> hits) const;
  Hit hit(const Vector2& ray) const;

  /// The plane normal · X = distance in which a face lies, X in the camera's frame, and the texture on it: the place of
  /// X is origin + (axes[0] · X, axes[1] · X) [m].
  struct Face {
    Vector3 normal;
    double distance;
    std::array<Vector3, 2> axes;
    Vector2 origin;

    /// Where a ray (x, y, 1) meets the plane: depth along the camera's z [m], the place (u, v) on the texture [m], and
    /// the derivatives of u and v by x and y.
    struct Place {
      double depth, u, v, ux, uy, vx, vy;
    };
    Place at(double x, double y) const {
      const Vector3 &n = normal, &p = axes[0], &q = axes[1];
      const double inverse = 1.0 / (n.x() * x + (n.y() * y + n.z())), depth = distance * inverse;
      // From X = depth (x, y, 1) being in the plane: ∂depth = −depth ∂(normal · ray) / (normal · ray).
      const double along_u = (p.x() * x + (p.y() * y + p.z())) * inverse;
      const double along_v = (q.x() * x + (q.y() * y + q.z())) * inverse;
      return {depth,
              origin.x() + distance * along_u,
              origin.y() + distance * along_v,
              depth * (p.x() - along_u * n.x()),
              depth * (p.y() - along_u * n.y()),
              depth * (q.x() - along_v * n.x()),
              depth * (q.y() - along_v * n.y())};
    }
  };
  Face face(const Hit& hit) const;

  /// The line l · (x, y, 1) = 0 between two faces that are neighbours in the image, as their edges have it: one of an
  /// outline, or that in which the faces' planes meet. None if no such line has all rays that hit `a` on one side and
  /// all others on the other. l is positive at `a`.
  std::optional<Vector3> border(const Hit& a, const Hit& b, std::span<const Vector2> rays,
                                std::span<const Hit> hits) const;

  static constexpr std::size_t kTogether = 32;  ///< so many rays share a search

 private:
  struct Seen {
    const Surface* surface;
    Matrix3 R;          ///< camera to surface
    Vector3 eye;        ///< camera in the surface's frame
    Vector3 low, high;  ///< from the camera to the faces −half and +half, along the surface's axes
    Vector3 centre;     ///< in the camera's frame
    double radius;      ///< of the sphere around a box
    double tangent;     ///< length from the camera to its tangent point on the sphere; 0 inside
  };
  /// Rays whose x and y are no farther from those of the middle one than the radius.
  struct Beam {
    Vector3 middle;
    double radius;
    double length;  ///< of the middle one
    double cosine;  ///< of the angle whose sine is the radius
  };
  struct Bundle {
    std::array<double, kTogether> x, y;
  };
  struct Meeting {
    std::array<double, kTogether> depth, face;  ///< depth: infinite where a ray does not meet it
  };
  void hit_together(std::span<const Vector2> rays, std::span<Hit> hits) const;
  void hit_surface(std::size_t surface, const Bundle& bundle, std::span<Hit> hits) const;
  static bool may_reach(const Seen& seen, const Beam& beam);
  static void meet_plane(const Seen& seen, const Bundle& rays, std::size_t count, Meeting& meeting);
  template <bool kInside>
  static void meet_box(const Seen& seen, const Bundle& rays, std::size_t count, Meeting& meeting);

  SE3 T_world_camera_;
  std::vector<Seen> seen_;
};

}  // namespace evbench
