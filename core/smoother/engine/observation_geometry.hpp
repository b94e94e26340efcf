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

/// The parameters that all observations of an interval share, under a motion prior with this number of orders
/// (MotionPrior). ξ(τ) is a combination of `kTerms` vectors: ϖ_0, ξ_1, w_1, and with 3 orders ϖ_0', c_1 (GpInterval).
template <int Orders>
struct Interval {
  static constexpr std::size_t kTerms = 2 * Orders - 1;

  explicit Interval(const GpInterval& interval)
      : t0(interval.t0()), dt(interval.dt()), singer(interval.singer_basis()) {
    set(0, interval.velocity0());
    set(1, interval.xi1());
    set(2, interval.w1());
    if constexpr (Orders == 3) {
      set(3, interval.acceleration0());
      set(4, interval.c1());
    }
  }

  double t0, dt;
  std::array<Lane3, kTerms> phi, rho;
  const singer::Basis& singer;

 private:
  void set(std::size_t term, const Vector6& xi) {
    phi[term] = lane3(xi.head<3>());
    rho[term] = lane3(xi.tail<3>());
  }
};

/// Calls call.operator()<orders, range>() for the orders of the motion prior and the range of an upper bound of |φ(τ)|
/// in the interval.
template <class Call>
void with_kind_of(const GpInterval& interval, Call call) {
  const auto with_range = [&]<int orders>(double bound) {
    if (bound < 1.0) return call.template operator()<orders, Range::small>();
    if (bound < 3.5) return call.template operator()<orders, Range::medium>();
    call.template operator()<orders, Range::any>();
  };
  const double dt = interval.dt(), end = interval.xi1().head<3>().norm();
  const double velocities = interval.velocity0().head<3>().norm() + interval.w1().head<3>().norm();
  if (!interval.prior().has_acceleration())
    return with_range.template operator()<2>(4.0 / 27.0 * dt * velocities + end);
  // Between the cubic and the quintic Hermite polynomial, whose weights are at most 0.2 Δt and 0.018 Δt².
  const double accelerations = interval.acceleration0().head<3>().norm() + interval.c1().head<3>().norm();
  with_range.template operator()<3>(0.2 * dt * velocities + 0.018 * dt * dt * accelerations + end);
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

/// The weights of the vectors of Interval in ξ(τ).
template <int Orders>
using Basis = std::array<Lane, Interval<Orders>::kTerms>;

inline Basis<2> basis_at(const Interval<2>& interval, Lane t) {
  const Lane s = (t - interval.t0) / interval.dt;
  const Lane rest = 1.0 - s;
  return {interval.dt * s * rest * rest, s * s * (3.0 - 2.0 * s), -interval.dt * s * s * rest};
}

/// singer::weights() for lanes.
inline Basis<3> basis_at(const Interval<3>& interval, Lane t) {
  const singer::Basis& of = interval.singer;
  const Lane s = (t - interval.t0) / interval.dt;
  const Lane square = s * s, z = of.square * square;
  Lane even{}, odd{};
  for (int n = of.terms; n-- > 0;) {
    even = even * z + singer::kEven[index(n)];
    odd = odd * z + singer::kOdd[index(n)];
  }
  const Lane p3 = square * s, p4 = square * square * even, p5 = square * square * s * odd;
  const auto from_end = [&](Eigen::Index c) {
    return p3 * of.from_end(0, c) + p4 * of.from_end(1, c) + p5 * of.from_end(2, c);
  };
  const Lane end = from_end(0), end_velocity = from_end(1), end_acceleration = from_end(2);
  const double dt = of.dt, half = 0.5 * dt * dt;
  return {dt * s - dt * end - end_velocity, end, end_velocity,
          half * square - half * end - dt * end_velocity - end_acceleration, end_acceleration};
}

/// ξ(τ) = (φ, ρ) and the terms of its exponential.
struct Tangent {
  Lane3 phi, rho, u1, u2;  ///< u1 = φ × ρ, u2 = φ × u1
  Coefficients k;
  Lane s1;  ///< sin θ/θ
};

template <Range range, int Orders>
Tangent tangent(const Interval<Orders>& interval, const Basis<Orders>& basis) {
  Tangent g;
  g.phi = basis[0] * interval.phi[0] + basis[1] * interval.phi[1] + basis[2] * interval.phi[2];
  g.rho = basis[0] * interval.rho[0] + basis[1] * interval.rho[1] + basis[2] * interval.rho[2];
  if constexpr (Orders == 3) {
    g.phi = g.phi + basis[3] * interval.phi[3] + basis[4] * interval.phi[4];
    g.rho = g.rho + basis[3] * interval.rho[3] + basis[4] * interval.rho[4];
  }
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
