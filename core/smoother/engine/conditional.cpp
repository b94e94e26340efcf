#include "core/smoother/engine/conditional.hpp"

#include <algorithm>
#include <array>

namespace evbench::smoother {
namespace {

constexpr int kMaxPivots = 3 * kMaxPivotLandmarks + 18;

/// Copies the columns `indices` of a symmetric matrix into A and clears these rows and columns.
void take_columns(Root& root, std::span<const int> indices, int n, double* A) {
  const std::ptrdiff_t stride = root.stride();
  double* H = root.H();
  for (const int s : indices) {
    const double* column = H + s * stride;
    for (int i = 0; i < s; ++i) A[i] = H[i * stride + s];
    std::copy(column + s, column + n, A + s);
    A += n;
  }
  for (const int s : indices) {
    for (int i = 0; i < s; ++i) H[i * stride + s] = 0.0;
    std::fill(H + s * stride + s, H + s * stride + n, 0.0);
  }
}

}  // namespace

int eliminate(Root& root, std::span<const int> landmarks, int state, Conditional& result) {
  std::array<int, kMaxPivots> indices;
  int p = 0;
  result.landmarks.assign(landmarks.begin(), landmarks.end());
  result.rows.clear();
  result.state = state;
  for (const int landmark : landmarks) {
    result.rows.push_back(root.row_of_slot(root.slot_of(landmark)));
    for (int i = 0; i < 3; ++i) indices[index(p++)] = result.rows.back() + i;
  }
  if (state >= 0) {
    result.rows.push_back(root.row_of_state(state));
    for (int i = 0; i < root.state_size(); ++i) indices[index(p++)] = result.rows.back() + i;
  }
  const int n = root.extent();
  result.pivots = p;
  result.extent = n;
  result.A.resize(index(n * p));
  result.L.resize(index(p * p));
  result.y.resize(index(p));
  double* A = result.A.data();
  double* L = result.L.data();
  double* y = result.y.data();
  take_columns(root, std::span(indices).first(index(p)), n, A);
  for (int c = 0; c < p; ++c) {
    for (int r = 0; r < p; ++r) {
      double& value = A[c * n + indices[index(r)]];
      L[c * p + r] = value;
      value = 0.0;
    }
    double& b = root.b()[indices[index(c)]];
    y[c] = b;
    b = 0.0;
  }
  const int failed = cholesky(L, p, p, kPivotTolerance);
  if (failed >= 0) return std::min(failed / 3, static_cast<int>(landmarks.size()));
  solve_right_transposed(A, n, n, L, p, p);
  subtract_outer_product(root.H(), root.stride(), A, n, n, p);
  as_matrix(L, p, p, p).triangularView<Eigen::Lower>().solveInPlace(as_vector(y, p));
  as_vector(root.b(), n).noalias() -= as_matrix(A, n, p, n) * as_vector(y, p);
  for (const int landmark : landmarks) root.leave(landmark);
  return -1;
}

void Conditional::back_substitute(const double* z, double* delta) const {
  std::array<double, kMaxPivots> values;
  auto x = as_vector(values.data(), pivots);
  x = as_vector(z, pivots);
  x.noalias() -= as_matrix(A.data(), extent, pivots, extent).transpose() * as_vector(delta, extent);
  as_matrix(L.data(), pivots, pivots, pivots).transpose().triangularView<Eigen::Upper>().solveInPlace(x);
  const double* from = values.data();
  for_each_pivot([&](int row, int size) {
    std::copy(from, from + size, delta + row);
    from += size;
  });
}

void Conditional::back_substitute(double* z, int z_stride, double* x, int x_stride, int columns) const {
  auto solved = as_matrix(z, pivots, columns, z_stride);
  auto places = as_matrix(x, extent, columns, x_stride);
  solved.noalias() -= as_matrix(A.data(), extent, pivots, extent).transpose() * places;
  as_matrix(L.data(), pivots, pivots, pivots).transpose().triangularView<Eigen::Upper>().solveInPlace(solved);
  int from = 0;
  for_each_pivot([&](int row, int size) {
    places.middleRows(row, size) = solved.middleRows(from, size);
    from += size;
  });
}

void Conditional::eliminate(double* r, int r_stride, double* z, int z_stride, int columns) const {
  auto rest = as_matrix(r, extent, columns, r_stride);
  auto taken = as_matrix(z, pivots, columns, z_stride);
  int to = 0;
  for_each_pivot([&](int row, int size) {
    taken.middleRows(to, size) = rest.middleRows(row, size);
    rest.middleRows(row, size).setZero();
    to += size;
  });
  as_matrix(L.data(), pivots, pivots, pivots).triangularView<Eigen::Lower>().solveInPlace(taken);
  add_product(r, r_stride, -1.0, A.data(), extent, extent, z, z_stride, pivots, columns);
}

}  // namespace evbench::smoother
