#pragma once

#include <Eigen/Core>
#include <cstdlib>
#include <new>
#include <vector>

namespace evbench::smoother {

/// Allocates on cache lines.
template <class T>
struct CacheLineAllocator {
  using value_type = T;
  static constexpr std::align_val_t kAlignment{64};
  CacheLineAllocator() = default;
  template <class U>
  explicit CacheLineAllocator(const CacheLineAllocator<U>&) {}
  T* allocate(std::size_t n) { return static_cast<T*>(::operator new(n * sizeof(T), kAlignment)); }
  void deallocate(T* p, std::size_t) { ::operator delete(p, kAlignment); }
  bool operator==(const CacheLineAllocator&) const { return true; }
};
using Buffer = std::vector<double, CacheLineAllocator<double>>;

/// Extents of the dense kernels' operands are multiples of this.
inline constexpr int kPadding = 8;
inline int padded(int n) { return (n + kPadding - 1) / kPadding * kPadding; }

/// Operands as Eigen maps, for operations that Eigen does as fast as own kernels would (bench/micro/engine_micro.cpp).
inline auto as_matrix(const double* A, int rows, int columns, int stride) {
  return Eigen::Map<const Eigen::MatrixXd, 0, Eigen::OuterStride<>>(A, rows, columns, Eigen::OuterStride<>(stride));
}
inline auto as_matrix(double* A, int rows, int columns, int stride) {
  return Eigen::Map<Eigen::MatrixXd, 0, Eigen::OuterStride<>>(A, rows, columns, Eigen::OuterStride<>(stride));
}
inline auto as_vector(double* x, int size) { return Eigen::Map<Eigen::VectorXd>(x, size); }
inline auto as_vector(const double* x, int size) { return Eigen::Map<const Eigen::VectorXd>(x, size); }

// All matrices are stored by columns with a leading dimension. Of symmetric matrices the lower triangle is valid; the 8
// × 8 blocks on the diagonal may contain anything above it.

/// C −= A Aᵀ: C n × n symmetric, A n × p, n padded.
void subtract_outer_product(double* C, int ldc, const double* A, int lda, int n, int p);

/// C += factor A B: C n × columns, A n × p, B p × columns, n padded. For few columns, where Eigen copies A first.
void add_product(double* C, int ldc, double factor, const double* A, int lda, int n, const double* B, int ldb, int p,
                 int columns);

/// A ← A L⁻ᵀ: A n × p, n padded, L p × p lower.
void solve_right_transposed(double* A, int lda, int n, const double* L, int ldl, int p);

/// L ← the Cholesky factor of the p × p matrix in its place. Returns −1, or the first column whose pivot is not above
/// `tolerance` times that column's original diagonal element (then L is unusable).
int cholesky(double* L, int ldl, int p, double tolerance);

/// The same, blocked, for n × n with n padded.
int cholesky_blocked(double* L, int ldl, int n, double tolerance);

/// Pivots must exceed this share of their diagonal element; smaller ones are rounding errors in double precision.
inline constexpr double kPivotTolerance = 1e-13;

}  // namespace evbench::smoother
