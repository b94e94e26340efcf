#include "frontends/str/registration/motion_model.hpp"

#include <Eigen/QR>

#include "core/geometry/so3.hpp"

namespace evbench::str {
namespace {

Matrix3 unit(int row, int column) {
  Matrix3 G = Matrix3::Zero();
  G(row, column) = 1.0;
  return G;
}

}  // namespace

const std::vector<Matrix3>& generators(MotionModel model) {
  static const std::vector<Matrix3> rotation = {so3::hat(Vector3::UnitX()), so3::hat(Vector3::UnitY()),
                                                so3::hat(Vector3::UnitZ())};
  static const std::vector<Matrix3> translation = {unit(0, 2), unit(1, 2)};
  static const std::vector<Matrix3> planar_4 = {unit(0, 2), unit(1, 2), rotation[2], unit(0, 0) + unit(1, 1)};
  static const std::vector<Matrix3> planar_8 = {unit(0, 2), unit(1, 2), unit(0, 0), unit(0, 1),
                                                unit(1, 0), unit(1, 1), unit(2, 0), unit(2, 1)};
  switch (model) {
    case MotionModel::rotation: return rotation;
    case MotionModel::translation: return translation;
    case MotionModel::planar_4: return planar_4;
    case MotionModel::planar_8: break;
  }
  return planar_8;
}

Matrix3 generator_matrix(MotionModel model, const MotionParameters& theta) {
  const std::vector<Matrix3>& G = generators(model);
  Matrix3 A = Matrix3::Zero();
  for (std::size_t k = 0; k < G.size(); ++k) A += theta[static_cast<Eigen::Index>(k)] * G[k];
  return A;
}

MotionParameters project_onto(MotionModel model, const Matrix3& A) {
  const std::vector<Matrix3>& G = generators(model);
  Eigen::Matrix<double, 9, Eigen::Dynamic> columns(9, static_cast<Eigen::Index>(G.size()) + 1);
  for (std::size_t k = 0; k < G.size(); ++k) columns.col(static_cast<Eigen::Index>(k)) = G[k].reshaped();
  columns.col(columns.cols() - 1) = Matrix3::Identity().reshaped();
  const Eigen::VectorXd solution = columns.colPivHouseholderQr().solve(A.reshaped());
  return solution.head(static_cast<Eigen::Index>(G.size()));
}

}  // namespace evbench::str
