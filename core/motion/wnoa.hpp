#pragma once

#include "core/geometry/se3.hpp"

namespace evbench {

/// White noise on acceleration: the GP prior ϖ' = w(t), w ~ GP(0, Qc δ(t − t')), on SE(3) (Barfoot 2014, Dong 2017).
/// Qc is diagonal, in the body frame: rad²/s³ for the rotation, m²/s³ for the translation.
namespace wnoa {

/// Covariance of (Δpose, Δvelocity) accumulated over dt [s]: [[dt³/3 Qc, dt²/2 Qc], [dt²/2 Qc, dt Qc]].
Matrix12 process_covariance(double dt, const Vector6& qc);

/// Its inverse, in closed form: [[12/dt³ Qc⁻¹, −6/dt² Qc⁻¹], [−6/dt² Qc⁻¹, 4/dt Qc⁻¹]].
Matrix12 process_information(double dt, const Vector6& qc);

/// The constant-velocity transition [[1, dt], [0, 1]].
Matrix12 transition(double dt);

}  // namespace wnoa
}  // namespace evbench
