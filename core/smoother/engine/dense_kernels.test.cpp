#include "core/smoother/engine/dense_kernels.hpp"

#include <Eigen/Cholesky>

#include "core/testing/catch2.hpp"

namespace evbench::smoother {
namespace {

using Matrix = Eigen::MatrixXd;

Matrix lower(const Matrix& m) { return m.triangularView<Eigen::Lower>(); }

}  // namespace

TEST_CASE("Dense kernels agree with Eigen, at sizes on both sides of their blocks") {
  std::srand(1);
  for (const int n : {8, 16, 24, 32, 48, 56, 104, 208}) {
    for (const int p : {1, 3, 12, 20, 36}) {
      CAPTURE(n, p);
      const Matrix A = Matrix::Random(n, p);
      const Matrix start = Matrix::Random(n, n);
      Matrix C = start;
      subtract_outer_product(C.data(), n, A.data(), n, n, p);
      CHECK((lower(C) - lower(start - A * A.transpose())).norm() < 1e-12 * n * p);

      const Matrix B = Matrix::Random(p, 4);
      Matrix D = start.leftCols(4);
      add_product(D.data(), n, -2.0, A.data(), n, n, B.data(), p, p, 4);
      CHECK((D - (start.leftCols(4) - 2.0 * A * B)).norm() < 1e-12 * n * p);

      const Matrix S = Matrix::Identity(p, p) * 4.0 + Matrix::Random(p, p) / p;
      const Matrix L = lower(S);
      Matrix X = A;
      solve_right_transposed(X.data(), n, n, L.data(), p, p);
      CHECK((X * L.transpose() - A).norm() < 1e-12 * n * p);
    }
    const Matrix G = Matrix::Random(n, n);
    const Matrix H = G * G.transpose() + 0.1 * n * Matrix::Identity(n, n);
    Matrix L = H;
    REQUIRE(cholesky_blocked(L.data(), n, n, 1e-13) == -1);
    CHECK((lower(L) * lower(L).transpose() - H).norm() < 1e-12 * H.norm());
  }
}

TEST_CASE("Cholesky factorisation names the column where a matrix stops being positive definite") {
  Matrix H = Matrix::Identity(48, 48);
  H(30, 30) = 0.0;
  CHECK(cholesky_blocked(H.data(), 48, 48, 1e-13) == 30);
  Matrix singular = Matrix::Identity(8, 8);
  singular(5, 4) = singular(4, 5) = 1.0;  // rows 4 and 5 are the same
  CHECK(cholesky(singular.data(), 8, 8, 1e-13) == 5);
}

}  // namespace evbench::smoother
