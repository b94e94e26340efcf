#include "backends/gp_map/engine/conditional.hpp"

#include <algorithm>
#include <array>

namespace evbench::gp_map {
namespace {

constexpr int kMaxPivots = 3 * kMaxPivotLandmarks + 12;

/// Copies a symmetric matrix's columns `indices` into A and clears them there, rows and columns.
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
    result.rows.push_back(Root::row_of_slot(root.slot_of(landmark)));
    for (int i = 0; i < 3; ++i) indices[static_cast<std::size_t>(p++)] = result.rows.back() + i;
  }
  if (state >= 0) {
    result.rows.push_back(Root::row_of_state(state));
    for (int i = 0; i < 12; ++i) indices[static_cast<std::size_t>(p++)] = result.rows.back() + i;
  }
  const int n = root.extent();
  result.pivots = p;
  result.extent = n;
  result.A.resize(static_cast<std::size_t>(n * p));
  result.L.resize(static_cast<std::size_t>(p * p));
  result.y.resize(static_cast<std::size_t>(p));
  double* A = result.A.data();
  double* L = result.L.data();
  double* y = result.y.data();
  take_columns(root, std::span(indices).first(static_cast<std::size_t>(p)), n, A);
  for (int c = 0; c < p; ++c) {
    for (int r = 0; r < p; ++r) {
      double& value = A[c * n + indices[static_cast<std::size_t>(r)]];
      L[c * p + r] = value;
      value = 0.0;
    }
    double& b = root.b()[indices[static_cast<std::size_t>(c)]];
    y[c] = b;
    b = 0.0;
  }
  const int failed = cholesky(L, p, p, kPivotTolerance);
  if (failed >= 0) return std::min(failed / 3, static_cast<int>(landmarks.size()));
  solve_right_transposed(A, n, n, L, p, p);
  solve_lower(L, p, p, y);
  subtract_outer_product(root.H(), root.stride(), A, n, n, p);
  subtract_product(root.b(), A, n, n, p, y);
  for (const int landmark : landmarks) root.leave(landmark);
  return -1;
}

void Conditional::back_substitute(double* delta) const {
  std::array<double, kMaxPivots> x;
  std::copy(y.begin(), y.begin() + pivots, x.begin());
  subtract_transposed_product(x.data(), A.data(), extent, extent, pivots, delta);
  solve_lower_transposed(L.data(), pivots, pivots, x.data());
  const double* from = x.data();
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const int size = i < landmarks.size() ? 3 : 12;
    std::copy(from, from + size, delta + rows[i]);
    from += size;
  }
}

}  // namespace evbench::gp_map
