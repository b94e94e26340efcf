#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/geometry/types.hpp"

namespace evbench::str {

/// How the image moves while a batch of events lasts: a flow of rays (x, y, 1) that is linear in homogeneous
/// coordinates, d ray/dt = -A ray, with a constant matrix A = Σ θ_k G_k [1/s]. So exp((t - s) A) takes a ray seen at t
/// to the ray seen at s, up to its length. All models are handled alike.
enum class MotionModel {
  rotation,     ///< θ = body angular velocity ω of the camera [rad/s], A = ω^
  translation,  ///< θ = image velocity of the two axes [focal lengths/s], reversed
  planar_4,     ///< translation, rotation about the optical axis, zoom: fronto-parallel plane
  planar_8,     ///< any plane: all homographies
};

/// At most eight, as many as the model's generators.
using MotionParameters = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, 8, 1>;

/// The generators G_k of a model, in the order of its parameters.
const std::vector<Matrix3>& generators(MotionModel model);

/// A = Σ θ_k G_k.
Matrix3 generator_matrix(MotionModel model, const MotionParameters& theta);

/// The parameters of the model whose matrix is nearest to A, up to a multiple of the identity, which moves nothing.
MotionParameters project_onto(MotionModel model, const Matrix3& A);

}  // namespace evbench::str
