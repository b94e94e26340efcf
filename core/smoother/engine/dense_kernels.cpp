#include "core/smoother/engine/dense_kernels.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/smoother/engine/lanes.hpp"
#include "core/support/index.hpp"

namespace evbench::smoother {
namespace {

// The tile that is kept in registers: kVectors × kLanes rows, kColumns columns.
constexpr int kColumns = kLanes == 8 ? 8 : 4;
constexpr int kVectors = kLanes == 2 ? 2 : 3;
constexpr int kBlock = 24;  ///< columns of a panel of the blocked factorisation

template <int Vectors>
void subtract_tile(double* C, int ldc, const double* rows, const double* columns, int lda, int p) {
  std::array<std::array<Lane, kColumns>, Vectors> sums{};
  for (int k = 0; k < p; ++k) {
    std::array<Lane, Vectors> a;
    for (int v = 0; v < Vectors; ++v) a[v] = load(rows + v * kLanes);
#pragma GCC unroll 8
    for (int c = 0; c < kColumns; ++c) {
      for (int v = 0; v < Vectors; ++v) sums[v][c] += a[v] * columns[c];
    }
    rows += lda;
    columns += lda;
  }
  for (int c = 0; c < kColumns; ++c) {
    for (int v = 0; v < Vectors; ++v) {
      double* at = C + c * ldc + v * kLanes;
      store(at, load(at) - sums[v][c]);
    }
  }
}

template <int Columns, int Vectors>
void add_product_rows(double* C, int ldc, double factor, const double* A, int lda, const double* B, int ldb, int p) {
  std::array<std::array<Lane, Vectors>, Columns> sums{};
  for (int k = 0; k < p; ++k, A += lda) {
    for (int v = 0; v < Vectors; ++v) {
      const Lane a = load(A + v * kLanes);
      for (int c = 0; c < Columns; ++c) sums[c][v] += a * B[c * ldb + k];
    }
  }
  for (int c = 0; c < Columns; ++c) {
    for (int v = 0; v < Vectors; ++v) {
      double* at = C + c * ldc + v * kLanes;
      store(at, load(at) + factor * sums[c][v]);
    }
  }
}

template <int Columns>
void add_product_columns(double* C, int ldc, double factor, const double* A, int lda, int n, const double* B, int ldb,
                         int p) {
  constexpr int kRows = 4 * kLanes;
  int r = 0;
  for (; r + kRows <= n; r += kRows) add_product_rows<Columns, 4>(C + r, ldc, factor, A + r, lda, B, ldb, p);
  for (; r < n; r += kLanes) add_product_rows<Columns, 1>(C + r, ldc, factor, A + r, lda, B, ldb, p);
}

template <int Vectors>
void solve_right_rows(double* A, int lda, const double* L, int ldl, int p) {
  for (int k = 0; k < p; ++k) {
    std::array<Lane, Vectors> x;
    for (int v = 0; v < Vectors; ++v) x[v] = load(A + k * lda + v * kLanes);
    for (int j = 0; j < k; ++j) {
      const double l = L[j * ldl + k];
      for (int v = 0; v < Vectors; ++v) x[v] -= load(A + j * lda + v * kLanes) * l;
    }
    const double scale = 1.0 / L[k * ldl + k];
    for (int v = 0; v < Vectors; ++v) store(A + k * lda + v * kLanes, x[v] * scale);
  }
}

}  // namespace

void subtract_outer_product(double* C, int ldc, const double* A, int lda, int n, int p) {
  for (int c = 0; c < n; c += kColumns) {
    double* column = C + static_cast<std::ptrdiff_t>(c) * ldc;
    int r = c;
    for (; r + kVectors * kLanes <= n; r += kVectors * kLanes) {
      subtract_tile<kVectors>(column + r, ldc, A + r, A + c, lda, p);
    }
    for (; r < n; r += kLanes) subtract_tile<1>(column + r, ldc, A + r, A + c, lda, p);
  }
}

void add_product(double* C, int ldc, double factor, const double* A, int lda, int n, const double* B, int ldb, int p,
                 int columns) {
  int c = 0;
  for (; c + 3 <= columns; c += 3) add_product_columns<3>(C + c * ldc, ldc, factor, A, lda, n, B + c * ldb, ldb, p);
  for (; c < columns; ++c) add_product_columns<1>(C + c * ldc, ldc, factor, A, lda, n, B + c * ldb, ldb, p);
}

void solve_right_transposed(double* A, int lda, int n, const double* L, int ldl, int p) {
  constexpr int kRows = 4 * kLanes;
  int r = 0;
  for (; r + kRows <= n; r += kRows) solve_right_rows<4>(A + r, lda, L, ldl, p);
  for (; r < n; r += kLanes) solve_right_rows<1>(A + r, lda, L, ldl, p);
}

int cholesky(double* L, int ldl, int p, double tolerance) {
  Eigen::Map<Eigen::MatrixXd, 0, Eigen::OuterStride<>> A(L, p, p, Eigen::OuterStride<>(ldl));
  for (int j = 0; j < p; ++j) {
    const int below = p - j - 1;
    const double original = A(j, j), pivot = original - A.row(j).head(j).squaredNorm();
    if (!(pivot > tolerance * original) || !std::isfinite(pivot)) return j;
    A(j, j) = std::sqrt(pivot);
    auto column = A.col(j).tail(below);
    column.noalias() -= A.bottomLeftCorner(below, j) * A.row(j).head(j).transpose();
    column /= A(j, j);
  }
  return -1;
}

int cholesky_blocked(double* L, int ldl, int n, double tolerance) {
  // Pivots are compared with the diagonal before any elimination.
  Buffer original(index(n));
  for (int i = 0; i < n; ++i) original[index(i)] = L[static_cast<std::ptrdiff_t>(i) * ldl + i];
  for (int j = 0; j < n; j += kBlock) {
    const int width = std::min(kBlock, n - j);
    const int below = n - j - width;
    double* diagonal = L + static_cast<std::ptrdiff_t>(j) * ldl + j;
    const int failed = cholesky(diagonal, ldl, width, 0.0);
    if (failed >= 0) return j + failed;
    for (int i = 0; i < width; ++i) {
      const double pivot = diagonal[i * ldl + i] * diagonal[i * ldl + i];
      if (!(pivot > tolerance * original[index(j + i)])) return j + i;
    }
    if (below == 0) break;
    double* panel = diagonal + width;
    solve_right_transposed(panel, ldl, below, diagonal, ldl, width);
    subtract_outer_product(diagonal + static_cast<std::ptrdiff_t>(width) * (ldl + 1), ldl, panel, ldl, below, width);
  }
  return -1;
}

}  // namespace evbench::smoother
