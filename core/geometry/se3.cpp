#include "core/geometry/se3.hpp"

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

}  // namespace evbench::se3
