#include "backends/gp_map/engine/dense_kernels.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "backends/gp_map/engine/lanes.hpp"

namespace evbench::gp_map {
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

/// x −= Aᵀ y for a few columns of A.
template <int Columns>
void subtract_dots(double* x, const double* A, int lda, int n, const double* y) {
  std::array<Lane, Columns> sums{};
  for (int r = 0; r < n; r += kLanes) {
    const Lane value = load(y + r);
    for (int c = 0; c < Columns; ++c) sums[c] += load(A + c * lda + r) * value;
  }
  for (int c = 0; c < Columns; ++c) x[c] -= sum(sums[c]);
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

void solve_right_transposed(double* A, int lda, int n, const double* L, int ldl, int p) {
  constexpr int kRows = 4 * kLanes;
  int r = 0;
  for (; r + kRows <= n; r += kRows) solve_right_rows<4>(A + r, lda, L, ldl, p);
  for (; r < n; r += kLanes) solve_right_rows<1>(A + r, lda, L, ldl, p);
}

int cholesky(double* L, int ldl, int p, double tolerance) {
  for (int j = 0; j < p; ++j) {
    double* column = L + j * ldl;
    const double original = column[j];
    double pivot = original;
    for (int i = 0; i < j; ++i) pivot -= L[i * ldl + j] * L[i * ldl + j];
    if (!(pivot > tolerance * original) || !std::isfinite(pivot)) return j;
    for (int i = 0; i < j; ++i) {
      const double factor = L[i * ldl + j];
      const double* other = L + i * ldl;
      for (int r = j + 1; r < p; ++r) column[r] -= other[r] * factor;
    }
    column[j] = std::sqrt(pivot);
    const double scale = 1.0 / column[j];
    for (int r = j + 1; r < p; ++r) column[r] *= scale;
  }
  return -1;
}

int cholesky_blocked(double* L, int ldl, int n, double tolerance) {
  // Pivots are judged against the diagonal before anything was eliminated.
  Buffer original(static_cast<std::size_t>(n));
  for (int i = 0; i < n; ++i) original[static_cast<std::size_t>(i)] = L[static_cast<std::ptrdiff_t>(i) * ldl + i];
  for (int j = 0; j < n; j += kBlock) {
    const int width = std::min(kBlock, n - j);
    const int below = n - j - width;
    double* diagonal = L + static_cast<std::ptrdiff_t>(j) * ldl + j;
    const int failed = cholesky(diagonal, ldl, width, 0.0);
    if (failed >= 0) return j + failed;
    for (int i = 0; i < width; ++i) {
      const double pivot = diagonal[i * ldl + i] * diagonal[i * ldl + i];
      if (!(pivot > tolerance * original[static_cast<std::size_t>(j + i)])) return j + i;
    }
    if (below == 0) break;
    double* panel = diagonal + width;
    solve_right_transposed(panel, ldl, below, diagonal, ldl, width);
    subtract_outer_product(diagonal + static_cast<std::ptrdiff_t>(width) * (ldl + 1), ldl, panel, ldl, below, width);
  }
  return -1;
}

void solve_lower(const double* L, int ldl, int n, double* x) {
  for (int j = 0; j < n; ++j) {
    const double* column = L + static_cast<std::ptrdiff_t>(j) * ldl;
    x[j] /= column[j];
    const double value = x[j];
    for (int r = j + 1; r < n; ++r) x[r] -= column[r] * value;
  }
}

void solve_lower_transposed(const double* L, int ldl, int n, double* x) {
  for (int j = n - 1; j >= 0; --j) {
    const double* column = L + static_cast<std::ptrdiff_t>(j) * ldl;
    Lane sums{};
    int r = j + 1;
    for (; r + kLanes <= n; r += kLanes) sums += load(column + r) * load(x + r);
    double value = x[j] - sum(sums);
    for (; r < n; ++r) value -= column[r] * x[r];
    x[j] = value / column[j];
  }
}

void subtract_product(double* y, const double* A, int lda, int n, int p, const double* x) {
  for (int r = 0; r < n; r += kLanes) {
    Lane value = load(y + r);
    const double* at = A + r;
    for (int k = 0; k < p; ++k, at += lda) value -= load(at) * x[k];
    store(y + r, value);
  }
}

void subtract_transposed_product(double* x, const double* A, int lda, int n, int p, const double* y) {
  constexpr int kTogether = 6;  // enough independent sums to hide an addition's latency
  int k = 0;
  for (; k + kTogether <= p; k += kTogether) subtract_dots<kTogether>(x + k, A + std::ptrdiff_t{k} * lda, lda, n, y);
  for (; k + 3 <= p; k += 3) subtract_dots<3>(x + k, A + std::ptrdiff_t{k} * lda, lda, n, y);
  for (; k < p; ++k) subtract_dots<1>(x + k, A + std::ptrdiff_t{k} * lda, lda, n, y);
}

}  // namespace evbench::gp_map
