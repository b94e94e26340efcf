#pragma once

namespace evbench {

/// A scalar function of z = θ² with its first three derivatives with respect to z.
struct CoefficientJet {
  double f = 0.0;    ///< value
  double d = 0.0;    ///< first derivative with respect to z
  double dd = 0.0;   ///< second derivative with respect to z
  double ddd = 0.0;  ///< third derivative with respect to z
};

/// The analytic functions of z = θ² in exp, log and the Jacobians of SO(3) and SE(3):
///   b(z) = (1 − cos θ)/θ²,  c(z) = (θ − sin θ)/θ³  (left Jacobian:  I + b φ^ + c φ^²)
///   h(z) = (1 − (θ/2) cot(θ/2))/θ²                 (its inverse:    I − φ^/2 + h φ^²)
/// Power series below θ = 1, closed forms with derivative recursions above: exact to rounding near zero, without a
/// special case at π. `inverse_jacobian_coefficient` has a pole at θ = 2π.
CoefficientJet coefficient_b(double z);
CoefficientJet coefficient_c(double z);
CoefficientJet inverse_jacobian_coefficient(double z);

}  // namespace evbench
