#pragma once

#include <array>

#include "core/geometry/lie_coefficients.hpp"
#include "core/smoother/engine/lane_math.hpp"
#include "core/smoother/factors.hpp"

/// Geometry of the observations of one interval, kLanes at a time: the camera's motion up to each, and its residual.
namespace evbench::smoother::lanes {

/// b, c, and their derivatives with respect to z = θ².
struct Coefficients {
  Lane b, c, db, dc;
};

/// 1/(2n + 2)! and 1/(2n + 3)!, alternating: b and c as power series in z.
inline constexpr int kMaxTerms = 16;
struct Series {
  std::array<double, kMaxTerms> b{}, c{};
  constexpr Series() {
    double sign = 1.0, factorial = 1.0;  // (2n + 1)!
    for (std::size_t n = 0; n < kMaxTerms; ++n) {
      const double even = factorial * static_cast<double>(2 * n + 2);
      const double odd = even * static_cast<double>(2 * n + 3);
      b[n] = sign / even;
      c[n] = sign / odd;
      factorial = odd;
      sign = -sign;
    }
  }
};
inline constexpr Series kSeries;

template <int Terms>
Coefficients series(Lane z) {
  Coefficients r{};
  for (std::size_t n = Terms; n-- > 0;) {  // Horner, with derivatives
    r.db = r.db * z + r.b;
    r.dc = r.dc * z + r.c;
    r.b = r.b * z + kSeries.b[n];
    r.c = r.c * z + kSeries.c[n];
  }
  return r;
}

/// Method of computing the coefficients for all observations of an interval, chosen by the largest rotation angle in
/// it.
enum class Range { small, medium, any };

template <Range range>
Coefficients coefficients(Lane z) {
  if constexpr (range == Range::small) return series<8>(z);    // θ < 1: 2e-16
  if constexpr (range == Range::medium) return series<16>(z);  // θ < 3.5
  Coefficients r{};
  for (int i = 0; i < kLanes; ++i) {
    const CoefficientJet b = coefficient_b(z[i]);
    const CoefficientJet c = coefficient_c(z[i]);
    r.b[i] = b.f;
    r.c[i] = c.f;
    r.db[i] = b.d;
    r.dc[i] = c.d;
  }
  return r;
}

inline Lane3 lane3(const Vector3& v) { return {broadcast(v.x()), broadcast(v.y()), broadcast(v.z())}; }

/// The parameters that all observations of an interval share.
struct Interval {
  explicit Interval(const GpInterval& interval)
      : t0(interval.t0()),
        dt(interval.dt()),
        velocity_phi(lane3(interval.velocity0().head<3>())),
        velocity_rho(lane3(interval.velocity0().tail<3>())),
        xi1_phi(lane3(interval.xi1().head<3>())),
        xi1_rho(lane3(interval.xi1().tail<3>())),
        w1_phi(lane3(interval.w1().head<3>())),
        w1_rho(lane3(interval.w1().tail<3>())) {}

  double t0, dt;
  Lane3 velocity_phi, velocity_rho, xi1_phi, xi1_rho, w1_phi, w1_rho;
};

/// Calls call.operator()<range>() with the range of an upper bound of |φ(τ)| in the interval.
template <class Call>
void with_range_of(const GpInterval& interval, Call call) {
  const double bound =
      4.0 / 27.0 * interval.dt() * (interval.velocity0().head<3>().norm() + interval.w1().head<3>().norm()) +
      interval.xi1().head<3>().norm();
  if (bound < 1.0) return call.template operator()<Range::small>();
  if (bound < 3.5) return call.template operator()<Range::medium>();
  call.template operator()<Range::any>();
}

/// One observation per lane; `present` is 0 in a lane without one.
struct Measured {
  Lane t{}, u{}, v{}, present{};
  Lane xx{}, yx{}, yy{};  ///< of the whitening

  /// Sets t of all lanes: it must be in the interval even in a lane without observation.
  explicit Measured(double t0) : t(broadcast(t0)) {}

  void set(std::size_t lane, const Observation& z) {
    t[lane] = z.t;
    u[lane] = z.pixel.x();
    v[lane] = z.pixel.y();
    xx[lane] = z.whitening.xx;
    yx[lane] = z.whitening.yx;
    yy[lane] = z.whitening.yy;
    present[lane] = 1.0;
  }
};

/// The weights a, b, c of ξ(τ) = a ϖ_0 + b ξ_1 + c w_1 (GpInterval).
inline std::array<Lane, 3> hermite_basis(const Interval& interval, Lane t) {
  const Lane s = (t - interval.t0) / interval.dt;
  const Lane rest = 1.0 - s;
  return {interval.dt * s * rest * rest, s * s * (3.0 - 2.0 * s), -interval.dt * s * s * rest};
}

/// ξ(τ) = (φ, ρ) and the terms of its exponential.
struct Tangent {
  Lane3 phi, rho, u1, u2;  ///< u1 = φ × ρ, u2 = φ × u1
  Coefficients k;
  Lane s1;  ///< sin θ/θ
};

template <Range range>
Tangent tangent(const Interval& interval, const std::array<Lane, 3>& basis) {
  Tangent g;
  g.phi = basis[0] * interval.velocity_phi + basis[1] * interval.xi1_phi + basis[2] * interval.w1_phi;
  g.rho = basis[0] * interval.velocity_rho + basis[1] * interval.xi1_rho + basis[2] * interval.w1_rho;
  const Lane theta2 = dot(g.phi, g.phi);
  g.k = coefficients<range>(theta2);
  g.s1 = 1.0 - theta2 * g.k.c;
  g.u1 = cross(g.phi, g.rho);
  g.u2 = cross(g.phi, g.u1);
  return g;
}

/// Exp(ξ), applied to points and directions.
struct Motion {
  Lane3 phi, translation;
  Lane s1, b;

  /// Exp(−ξ) m.
  Lane3 into_camera(const Lane3& m) const {
    const Lane3 d = m - translation;
    const Lane3 d1 = cross(phi, d);
    return d - s1 * d1 + b * cross(phi, d1);
  }

  /// Rotates a direction in the camera at τ into the frame of the first state: R D.
  Lane3 turn_back(const Lane3& D) const {
    const Lane3 c1 = cross(phi, D);
    return D + s1 * c1 + b * cross(phi, c1);
  }
};

inline Motion motion(const Tangent& g) { return {g.phi, g.rho + g.k.b * g.u1 + g.k.c * g.u2, g.s1, g.k.b}; }

/// The whitened residual of the point q in the camera; behind it both components are 2 fx/σ, constant, where σ is the
/// geometric mean over all directions.
struct Residual {
  LaneBits in_front;
  Lane x, y, inverse_z;  ///< in front: the projection of q in normalised coordinates
  Lane dx, dy;           ///< in front: the residual [px]
  Lane e0, e1, square;

  Lane px() const { return sqrt(dx * dx + dy * dy); }
};

inline Residual residual_of(const PinholeCamera& camera, const Lane3& q, const Measured& z) {
  Residual r;
  r.in_front = q.z > 0.0;
  r.inverse_z = 1.0 / (r.in_front ? q.z : broadcast(1.0));
  r.x = q.x * r.inverse_z;
  r.y = q.y * r.inverse_z;
  r.dx = camera.fx * r.x + camera.cx - z.u;
  r.dy = camera.fy * r.y + camera.cy - z.v;
  const Lane behind = 2.0 * camera.fx * sqrt(z.xx * z.yy);
  r.e0 = r.in_front ? z.xx * r.dx : behind;
  r.e1 = r.in_front ? z.yx * r.dx + z.yy * r.dy : behind;
  r.square = r.e0 * r.e0 + r.e1 * r.e1;
  return r;
}

/// The rows of the whitened projection's Jacobian with respect to q.
struct ImageRows {
  Lane3 x, y;
};

inline ImageRows image_rows(const PinholeCamera& camera, const Residual& r, const Measured& z) {
  const Lane ax = camera.fx * r.inverse_z, ay = camera.fy * r.inverse_z;
  const Lane yx = z.yx * ax, yy = z.yy * ay;
  return {{z.xx * ax, Lane{}, -z.xx * ax * r.x}, {yx, yy, -yx * r.x - yy * r.y}};
}

}  // namespace evbench::smoother::lanes
