#include "core/smoother/engine/returns.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <iterator>
#include <utility>

namespace evbench::smoother {

void ReturnRows::clear() {
  ids.clear();
  stride = 0;
}

void ReturnRows::append(int id, const double* Z, int pivots) {
  const int row = 3 * static_cast<int>(ids.size());
  if (row + 3 > stride) {
    const int wider = padded(row + 3 + row / 2);
    Buffer moved(index(wider * pivots), 0.0);
    for (int p = 0; p < pivots; ++p) std::copy_n(Zt.begin() + p * stride, row, moved.begin() + p * wider);
    Zt = std::move(moved);
    stride = wider;
  }
  for (int p = 0; p < pivots; ++p) {
    for (int i = 0; i < 3; ++i) Zt[index(p * stride + row + i)] = Z[i * pivots + p];
  }
  ids.push_back(id);
}

ForwardPass::ForwardPass(const Returns& returns, int stage, int columns)
    : returns_(returns), first_(returns.first_after(stage)), next_(first_) {
  sums_.setZero(3 * returns.ids(), columns);
  g_.resize(3 * (returns.size() - first_), columns);
}

ForwardPass::ForwardPass(const ForwardPass& all, int stage, int column, int columns)
    : ForwardPass(all.returns_, stage, columns) {
  next_ = all.next_;
  sums_ = all.sums_.middleCols(column, columns);
  const int known = 3 * (next_ - first_);
  g_.topRows(known) = all.g_.block(3 * (first_ - all.first_), column, known, columns);
}

void ForwardPass::add(const ReturnRows& stage, const double* z, int pivots) {
  if (stage.ids.empty()) return;
  const int rows = padded(3 * static_cast<int>(stage.ids.size())), columns = static_cast<int>(sums_.cols());
  product_.assign(index(rows * columns), 0.0);
  add_product(product_.data(), rows, 1.0, stage.Zt.data(), stage.stride, rows, z, pivots, pivots, columns);
  const auto product = as_matrix(product_.data(), rows, columns, rows);
  for (std::size_t i = 0; i < stage.ids.size(); ++i) {
    sums_.middleRows<3>(3 * stage.ids[i]) += product.middleRows<3>(3 * static_cast<int>(i));
  }
}

void ForwardPass::cross(int k, double* x, int stride) {
  for (; next_ < returns_.size() && returns_[next_].before <= k; ++next_) {
    const Return& other = returns_[next_];
    const int common = std::max(first_, other.first);
    Eigen::MatrixXd g = sums_.middleRows<3>(3 * other.id);
    g.noalias() -= other.g.bottomRows(3 * (next_ - common)).transpose() *
                   g_.middleRows(3 * (common - first_), 3 * (next_ - common));
    other.L.triangularView<Eigen::Lower>().solveInPlace(g);
    g_.middleRows<3>(3 * (next_ - first_)) = g;
    Eigen::Map<Eigen::MatrixXd, 0, Eigen::OuterStride<>> to(x, other.R.rows(), g.cols(), Eigen::OuterStride<>(stride));
    to.noalias() += other.R * g;
  }
}

void ForwardPass::resume(int k, const Eigen::Ref<const Eigen::MatrixXd>& g) {
  next_ = returns_.first_after(k - 1);
  const int known = 3 * (next_ - first_);
  g_.topRows(known) = g.topRows(known);
}

void BackwardPass::start(const Returns& returns, int first, Eigen::MatrixXd g) {
  first_ = first;
  next_ = returns.size();
  g_ = std::move(g);
  mu_.resize(3 * returns.ids(), g_.cols());
}

const Return* BackwardPass::next(const Returns& returns, int k) const {
  return next_ > first_ && returns[next_ - 1].before == k ? &returns[next_ - 1] : nullptr;
}

void BackwardPass::cross(const Return& last, Known3 known) {
  --next_;
  Known3& mu = known;
  mu -= g_.middleRows<3>(3 * (next_ - first_));
  last.L.transpose().triangularView<Eigen::Upper>().solveInPlace(mu);
  mu_.middleRows<3>(3 * last.id) = mu;
  const int common = std::max(first_, last.first);
  const int rows = 3 * (next_ - common);
  g_.middleRows(3 * (common - first_), rows).noalias() += last.g.bottomRows(rows).lazyProduct(mu);
}

void BackwardPass::cross(const Returns& returns, int k, const double* x, int stride) {
  while (const Return* last = next(returns, k)) {
    cross(*last,
          last->R.transpose() * as_matrix(x, static_cast<int>(last->R.rows()), static_cast<int>(g_.cols()), stride));
  }
}

const Eigen::MatrixXd& BackwardPass::gather(const ReturnRows& stage) {
  gathered_.resize(3 * static_cast<int>(stage.ids.size()), g_.cols());
  for (std::size_t i = 0; i < stage.ids.size(); ++i) {
    gathered_.middleRows<3>(3 * static_cast<int>(i)) = mu_.middleRows<3>(3 * stage.ids[i]);
  }
  return gathered_;
}

void BackwardPass::shift(const ReturnRows& stage, double* z, int pivots) {
  if (stage.ids.empty()) return;
  const Eigen::MatrixXd& mu = gather(stage);
  as_matrix(z, pivots, static_cast<int>(mu.cols()), pivots).noalias() +=
      as_matrix(stage.Zt.data(), static_cast<int>(mu.rows()), pivots, stage.stride).transpose() * mu;
}

/// The second column is the change of μ.
void EstimatePass::start(const Returns& returns) {
  Eigen::MatrixXd g = Eigen::MatrixXd::Zero(3 * returns.size(), 2);
  g.col(0) = returns.means();
  BackwardPass::start(returns, 0, std::move(g));
  change2_ = 0.0;
}

void EstimatePass::cross(Returns& returns, int k, const double* delta) {
  while (const Return* last = next(returns, k)) {
    Return& kept = returns[next_ - 1];
    Known3 known(3, 2);
    known.col(0) = last->R.transpose() * as_vector(delta, static_cast<int>(last->R.rows()));
    kept.known_before = std::exchange(kept.known, known.col(0) - kept.mean);
    known.col(1) = kept.known - kept.known_before;
    change2_ += known.col(1).squaredNorm();
    BackwardPass::cross(*last, std::move(known));
  }
}

void EstimatePass::swap_known(Returns& returns) const {
  for (int i = next_; i < returns.size(); ++i) std::swap(returns[i].known, returns[i].known_before);
}

void EstimatePass::shift(const ReturnRows& stage, double* z, int pivots) {
  if (stage.ids.empty()) return;
  const Eigen::MatrixXd& mu = gather(stage);
  const auto Z = as_matrix(stage.Zt.data(), static_cast<int>(mu.rows()), pivots, stage.stride).transpose();
  as_vector(z, pivots).noalias() += Z * mu.col(0);
  if (change2_ <= 0.0) return;
  shift_change_.noalias() = Z * mu.col(1);
  change2_ -= shift_change_.squaredNorm();
}

Walk::Walk(const Returns& returns, int stage, int rows, int landmarks)
    : pass(returns, stage, 3 * landmarks),
      x(Eigen::MatrixXd::Zero(rows, 3 * landmarks)),
      square(Eigen::MatrixXd::Zero(3 * landmarks, 3 * landmarks)),
      with_y(Eigen::VectorXd::Zero(3 * landmarks)) {}

Walk::Walk(const Walk& all, int landmark, int stage, int rows)
    : pass(all.pass, stage, 3 * landmark, 3),
      x(Eigen::MatrixXd::Zero(rows, 3)),
      square(all.square.block<3, 3>(3 * landmark, 3 * landmark)),
      with_y(all.with_y.segment<3>(3 * landmark)) {
  x.topRows(all.x.rows()) = all.x.middleCols<3>(3 * landmark);
}

int Returns::first_after(int stage) const {
  const auto later = std::ranges::upper_bound(returns_, stage, {}, &Return::before);
  return static_cast<int>(later - returns_.begin());
}

Eigen::VectorXd Returns::means() const {
  Eigen::VectorXd result(3 * size());
  for (int i = 0; i < size(); ++i) result.segment<3>(3 * i) = returns_[index(i)].mean;
  return result;
}

Return* Returns::find(int landmark, int from) {
  const auto found =
      std::ranges::find_if(returns_, [&](const Return& r) { return r.landmark == landmark && r.from == from; });
  return found == returns_.end() ? nullptr : &*found;
}

Return* Returns::last_of(int landmark) {
  const auto found =
      std::find_if(returns_.rbegin(), returns_.rend(), [&](const Return& r) { return r.landmark == landmark; });
  return found == returns_.rend() ? nullptr : &*found;
}

int Returns::new_id() {
  if (!free_.empty()) {
    const int id = free_.back();
    free_.pop_back();
    return id;
  }
  return ids_++;
}

Return* Returns::append(Return&& result, const Walk& walk, const Root& root) {
  constexpr double kLeastUnknown = 1e-8;
  const auto g = walk.pass.g();
  const Matrix3 covariance = walk.square - g.transpose() * g;
  const Eigen::LLT<Matrix3> factor(covariance);
  if (factor.info() != Eigen::Success) return nullptr;
  result.L = factor.matrixL();
  for (int i = 0; i < 3; ++i) {
    if (!(result.L(i, i) * result.L(i, i) > kLeastUnknown * walk.square(i, i))) return nullptr;
  }
  result.first = walk.pass.first();
  result.g = g;
  result.mean = walk.with_y;
  for (int i = result.first; i < size(); ++i) {
    result.mean -= result.g.middleRows<3>(3 * (i - result.first)).transpose() * returns_[index(i)].mean;
  }
  result.mean -= result.offset;
  result.L.triangularView<Eigen::Lower>().solveInPlace(result.mean);
  const int extent = root.extent();
  result.R.setZero(extent, 3);
  const auto rows = std::min<Eigen::Index>(extent, walk.x.rows());
  result.R.topRows(rows) = -walk.x.topRows(rows);
  result.R.middleRows<3>(root.row_of_slot(result.slot)).setIdentity();
  result.L.transpose().triangularView<Eigen::Upper>().solveInPlace<Eigen::OnTheRight>(result.R);
  returns_.push_back(std::move(result));
  return &returns_.back();
}

std::vector<Return> Returns::take_after(int done) {
  const auto first = returns_.begin() + first_after(done);
  std::vector<Return> result(std::make_move_iterator(first), std::make_move_iterator(returns_.end()));
  returns_.erase(first, returns_.end());
  return result;
}

void Returns::thin(int stage) {
  for (auto i = returns_.rbegin(); i != returns_.rend() && !i->checkpoints.empty(); ++i) {
    std::erase_if(i->checkpoints, [&](const Return::Checkpoint& c) { return c.stage < stage; });
  }
}

}  // namespace evbench::smoother
