#include "core/smoother/engine/root.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <map>
#include <numeric>
#include <vector>

#include "core/simulation/random.hpp"
#include "core/testing/catch2.hpp"

namespace evbench::smoother {
namespace {

constexpr int kLandmarks = 20;

/// The content of the root for each pair of landmarks, each landmark with the states, and each alone, by landmark.
std::map<std::pair<int, int>, Eigen::MatrixXd> content(const Root& root) {
  const int n = root.extent();
  Eigen::MatrixXd H = as_matrix(root.column(0), n, n, root.stride());
  H = Eigen::MatrixXd(H.selfadjointView<Eigen::Lower>());
  std::map<std::pair<int, int>, Eigen::MatrixXd> result;
  for (int i = 0; i < kLandmarks; ++i) {
    if (root.slot_of(i) < 0) continue;
    const int row = root.row_of_slot(root.slot_of(i));
    result[{i, -1}] = H.block(row, 0, 3, 2 * root.state_size());
    result[{i, -2}] = as_vector(root.b() + row, 3);
    for (int j = 0; j < kLandmarks; ++j) {
      if (root.slot_of(j) >= 0) result[{i, j}] = H.block(row, root.row_of_slot(root.slot_of(j)), 3, 3);
    }
  }
  result[{-1, -1}] = H.topLeftCorner(2 * root.state_size(), 2 * root.state_size());
  return result;
}

/// Removes a landmark as an elimination does.
void remove(Root& root, int landmark) {
  const int row = root.row_of_slot(root.slot_of(landmark));
  for (int i = row; i < row + 3; ++i) {
    for (int c = 0; c <= i; ++c) root.column(c)[i] = 0.0;
    for (int r = i; r < root.extent(); ++r) root.column(i)[r] = 0.0;
    root.b()[i] = 0.0;
  }
  root.leave(landmark);
}

}  // namespace

TEST_CASE("Landmarks that are moved to lower slots keep their information") {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Random random(seed);
    Root root(seed % 2 == 0 ? 12 : 18);
    for (int j = 0; j < kLandmarks; ++j) root.enter(j);
    Eigen::MatrixXd R(root.extent(), 8);
    for (double& value : R.reshaped()) value = random.uniform(-1.0, 1.0);
    R.bottomRows(root.extent() - root.row_of_slot(kLandmarks)).setZero();
    root.add_factor(R, Eigen::VectorXd::LinSpaced(8, -1.0, 1.0));
    int left = kLandmarks;
    for (int j = 0; j < kLandmarks; ++j) {
      if (random.uniform(0.0, 1.0) > 0.6) continue;
      remove(root, j);
      --left;
    }
    const auto before = content(root);
    std::map<int, int> slot;
    for (int j = 0; j < kLandmarks; ++j) slot[j] = root.slot_of(j);
    std::vector<double> x(static_cast<std::size_t>(2 * root.stride()));
    std::iota(x.begin(), x.end(), 0.0);
    for (int s = 0; s < root.slots(); ++s) {  // free slots are zero, as in the root
      if (root.occupant(s) >= 0) continue;
      for (const int column : {0, root.stride()}) std::fill_n(x.begin() + column + root.row_of_slot(s), 3, 0.0);
    }
    const std::vector<double> original = x;

    std::vector<SlotMove> moves;
    root.close_holes(moves);
    CHECK(root.slots() <= left + 4);
    const auto after = content(root);
    REQUIRE(after.size() == before.size());
    for (const auto& [key, value] : before) CHECK(after.at(key) == value);

    root.follow_moves(moves, x.data(), root.stride(), 2);
    for (int j = 0; j < kLandmarks; ++j) {
      if (slot[j] < 0) continue;
      for (const int column : {0, root.stride()}) {
        for (int i = 0; i < 3; ++i) {
          CHECK(x[static_cast<std::size_t>(column + root.row_of_slot(root.slot_of(j)) + i)] ==
                original[static_cast<std::size_t>(column + root.row_of_slot(slot[j]) + i)]);
        }
      }
    }
    root.undo_moves(moves, x.data(), root.stride(), 2);
    for (int j = 0; j < kLandmarks; ++j) {
      if (slot[j] < 0) continue;
      const auto at = static_cast<std::size_t>(root.row_of_slot(slot[j]));
      CHECK(std::equal(x.begin() + static_cast<long>(at), x.begin() + static_cast<long>(at) + 3,
                       original.begin() + static_cast<long>(at)));
    }
  }
}

}  // namespace evbench::smoother
