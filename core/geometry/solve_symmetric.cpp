#include "core/geometry/solve_symmetric.hpp"

#include <Eigen/Cholesky>

namespace evbench {

SmallVector solve_symmetric(const SmallSystem& H, const SmallVector& g) { return H.ldlt().solve(g); }

}  // namespace evbench
