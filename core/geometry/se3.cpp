#include "core/geometry/se3.hpp"

#include <array>

#include "core/geometry/lie_coefficients.hpp"
#include "core/geometry/so3.hpp"

namespace evbench::se3 {
namespace {

/// I + k1 ad + k2 ad² + k3 ad³ + k4 ad⁴, and the derivatives of the coefficients with respect to z = θ².
/// An even analytic function 1 + y g(y) or an odd one x g(y), y = x², reduced modulo (y + z)², is
/// g(−z) + g'(−z)(y + z): with G(z) = g(−z) the two coefficients are G − z G' and −G'.
struct AdPolynomial {
  double k1 = 0.0, k2 = 0.0, k3 = 0.0, k4 = 0.0;
  double d1 = 0.0, d2 = 0.0, d3 = 0.0, d4 = 0.0;
  double dd2 = 0.0, dd4 = 0.0;  ///< of J_r⁻¹
};

AdPolynomial right_jacobian_polynomial(double z) {
  const CoefficientJet b = coefficient_b(z);
  const CoefficientJet c = coefficient_c(z);
  AdPolynomial p;
  p.k1 = -(b.f - z * b.d);
  p.k2 = c.f - z * c.d;
  p.k3 = b.d;
  p.k4 = -c.d;
  p.d1 = z * b.dd;
  p.d2 = -z * c.dd;
  p.d3 = b.dd;
  p.d4 = -c.dd;
  return p;
}

AdPolynomial right_jacobian_inverse_polynomial(double z) {
  const CoefficientJet h = inverse_jacobian_coefficient(z);
  AdPolynomial p;
  p.k1 = 0.5;
  p.k2 = h.f - z * h.d;
  p.k4 = -h.d;
  p.d2 = -z * h.dd;
  p.d4 = -h.dd;
  p.dd2 = -h.dd - z * h.ddd;
  p.dd4 = -h.ddd;
  return p;
}

Matrix6 evaluate(const AdPolynomial& p, const Vector6& xi) {
  const Matrix6 a = ad(xi);
  const Matrix6 a2 = a * a;
  return Matrix6::Identity() + p.k1 * a + p.k2 * a2 + (p.k3 * a + p.k4 * a2) * a2;
}

Matrix6 differentiate(const AdPolynomial& p, const Vector6& xi, const Vector6& v) {
  const Matrix6 a = ad(xi);
  const Vector6 u1 = a * v;
  const Vector6 u2 = a * u1;
  const Vector6 u3 = a * u2;
  const Vector6 u4 = a * u3;
  const Matrix6 d1 = -ad(v);
  const Matrix6 d2 = a * d1 - ad(u1);
  const Matrix6 d3 = a * d2 - ad(u2);
  const Matrix6 d4 = a * d3 - ad(u3);
  Matrix6 result = p.k1 * d1 + p.k2 * d2 + p.k3 * d3 + p.k4 * d4;
  result.leftCols<3>() += 2.0 * (p.d1 * u1 + p.d2 * u2 + p.d3 * u3 + p.d4 * u4) * xi.head<3>().transpose();
  return result;
}

}  // namespace

SE3 exp(const Vector6& xi) {
  const Vector3 phi = xi.head<3>();
  return {so3::exp(phi), so3::left_jacobian(phi) * xi.tail<3>()};
}

Vector6 log(const SE3& T) {
  Vector6 xi;
  const Vector3 phi = so3::log(T.q);
  xi << phi, so3::left_jacobian_inverse(phi) * T.p;
  return xi;
}

Matrix6 adjoint(const SE3& T) {
  const Matrix3 R = T.R();
  Matrix6 m;
  m << R, Matrix3::Zero(), so3::hat(T.p) * R, R;
  return m;
}

Matrix6 ad(const Vector6& xi) {
  const Matrix3 phi = so3::hat(xi.head<3>());
  Matrix6 m;
  m << phi, Matrix3::Zero(), so3::hat(xi.tail<3>()), phi;
  return m;
}

Matrix6 left_jacobian(const Vector6& xi) { return right_jacobian(-xi); }

Matrix6 right_jacobian(const Vector6& xi) {
  return evaluate(right_jacobian_polynomial(xi.head<3>().squaredNorm()), xi);
}

Matrix6 left_jacobian_inverse(const Vector6& xi) { return right_jacobian_inverse(-xi); }

Matrix6 right_jacobian_inverse(const Vector6& xi) {
  return evaluate(right_jacobian_inverse_polynomial(xi.head<3>().squaredNorm()), xi);
}

Matrix6 d_right_jacobian(const Vector6& xi, const Vector6& v) {
  return differentiate(right_jacobian_polynomial(xi.head<3>().squaredNorm()), xi, v);
}

Matrix6 d_right_jacobian_inverse(const Vector6& xi, const Vector6& v) {
  return differentiate(right_jacobian_inverse_polynomial(xi.head<3>().squaredNorm()), xi, v);
}

/// By recursion over the powers of a = ad(ξ): with the dot for the derivative along ξ', u_n = aⁿ v has
/// u̇_n = ad(ξ') u_{n−1} + a u̇_{n−1}, and ∂u_n/∂ξ and ∂u̇_n/∂ξ follow by ∂(ad(ξ) u)/∂ξ = −ad(u).
InverseRate right_jacobian_inverse_rate(const Vector6& xi, const Vector6& xi_rate, const Vector6& v,
                                        const Vector6& v_rate) {
  const AdPolynomial p = right_jacobian_inverse_polynomial(xi.head<3>().squaredNorm());
  const std::array<double, 5> k = {1.0, p.k1, p.k2, p.k3, p.k4}, d = {0.0, p.d1, p.d2, p.d3, p.d4},
                              dd = {0.0, 0.0, p.dd2, 0.0, p.dd4};
  const Matrix6 a = ad(xi), a_rate = ad(xi_rate);
  const double z_rate = 2.0 * xi.head<3>().dot(xi_rate.head<3>());
  Vector6 u = v, u_rate = Vector6::Zero();
  Matrix6 U = Matrix6::Zero(), U_rate = Matrix6::Zero();              // by ξ
  Matrix6 power = Matrix6::Identity(), power_rate = Matrix6::Zero();  // aⁿ
  InverseRate result{evaluate(p, xi) * v_rate, differentiate(p, xi, v_rate), Matrix6::Zero()};
  for (std::size_t n = 1; n <= 4; ++n) {
    U_rate = (a_rate * U - ad(u_rate) + a * U_rate).eval();
    U = (a * U - ad(u)).eval();
    u_rate = (a_rate * u + a * u_rate).eval();
    u = (a * u).eval();
    power_rate = (a_rate * power + a * power_rate).eval();
    power = (a * power).eval();
    result.value += k[n] * u_rate + d[n] * z_rate * u;
    result.by_v += k[n] * power_rate + d[n] * z_rate * power;
    result.by_xi += k[n] * U_rate + d[n] * z_rate * U;
    result.by_xi.leftCols<3>() += 2.0 * (d[n] * u_rate + dd[n] * z_rate * u) * xi.head<3>().transpose() +
                                  2.0 * d[n] * u * xi_rate.head<3>().transpose();
  }
  return result;
}

}  // namespace evbench::se3
