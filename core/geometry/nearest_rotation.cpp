#include "core/geometry/nearest_rotation.hpp"

#include <Eigen/LU>
#include <Eigen/SVD>

namespace evbench {

NearestRotation nearest_rotation(const Matrix3& M) {
  const Eigen::JacobiSVD<Matrix3> svd(M, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Vector3 signs = Vector3::Ones();
  if (svd.matrixU().determinant() * svd.matrixV().determinant() < 0.0) signs.z() = -1.0;
  return {svd.matrixU() * signs.asDiagonal() * svd.matrixV().transpose(), svd.singularValues().dot(signs),
          svd.singularValues(), svd.matrixV().col(0)};
}

}  // namespace evbench
