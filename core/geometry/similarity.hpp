#pragma once

#include "core/geometry/se3.hpp"

namespace evbench {

/// A similarity transformation between two world frames: p' = R (scale p) + t, R' = R R_p.
struct Similarity {
  double scale = 1.0;
  SE3 T;

  Vector3 operator*(const Vector3& point) const { return T * (scale * point).eval(); }
  SE3 operator*(const SE3& pose) const { return T * SE3{pose.q, scale * pose.p}; }
  Similarity inverse() const {
    const SE3 back = T.inverse();
    return {1.0 / scale, {back.q, back.p / scale}};
  }
};

inline Similarity operator*(const Similarity& a, const Similarity& b) { return {a.scale * b.scale, a * b.T}; }

}  // namespace evbench
