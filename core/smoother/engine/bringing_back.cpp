#include <algorithm>
#include <iterator>
#include <limits>
#include <utility>

#include "core/smoother/engine/factorisation.hpp"

// Returns of eliminated landmarks to the root; returns.hpp and docs/algorithms/smoother.md have the derivation.
namespace evbench::smoother {

int Factorisation::oldest_redone(int first, const FactorGraph& graph) const {
  for (int i = returns_.size() - 1; i >= 0 && returns_[i].before >= first; --i) {
    const Return& known = returns_[i];
    if (known.offset.isZero(0.0)) continue;
    const int done = snapshot_before(first);
    if (known.from <= done) continue;
    int earlier = i - 1;
    while (earlier >= 0 && returns_[earlier].landmark != known.landmark) --earlier;
    const auto& seen = graph.landmarks[index(known.landmark)].intervals;
    const int start = earlier >= 0 ? returns_[earlier].before : seen.empty() ? first : seen.front();
    if (start > done || start >= first) continue;
    first = start;
    i = returns_.size();  // more returns may be affected
  }
  return first;
}

/// Takes back the returns after the last stage that is still done. Landmarks that a done stage eliminated return again.
/// The others are still in the root or not observed yet and do not leave it; if the linearisation point of one of them
/// has moved since its return, all stages that contain it must be redone. Returns the oldest of these.
int Factorisation::take_back_returns(const FactorGraph& graph) {
  std::vector<Return> taken = returns_.take_after(done_);
  std::ranges::move(taken_back_, std::back_inserter(taken));
  taken_back_.clear();
  int oldest = std::numeric_limits<int>::max();
  for (auto i = taken.rbegin(); i != taken.rend(); ++i) {
    const auto& seen = graph.landmarks[index(i->landmark)].intervals;
    landmarks_[index(i->landmark)].eliminated_at = i->from <= done_ ? i->from : -1;
    if (i->from <= done_) continue;
    const auto same = std::find_if(i + 1, taken.rend(), [&](const Return& r) { return r.landmark == i->landmark; });
    Return* earlier = same != taken.rend() ? &*same : returns_.last_of(i->landmark);
    if (earlier != nullptr) earlier->offset += i->offset;
    returns_.free_id(i->id);
    if (same != taken.rend() || i->offset.isZero(0.0)) continue;
    if (earlier != nullptr)
      oldest = std::min(oldest, earlier->before);
    else if (!seen.empty())
      oldest = std::min(oldest, seen.front());
  }
  std::ranges::copy_if(std::make_move_iterator(taken.begin()), std::make_move_iterator(taken.end()),
                       std::back_inserter(taken_back_), [&](const Return& r) { return r.from <= done_; });
  return oldest;
}

/// Returns landmarks to the present root. If this is impossible, the result is the stage that must be redone instead.
std::optional<int> Factorisation::bring_all_back(const FactorGraph& graph, const LinearisationPoints& points) {
  const int before = returns_.size();
  for (auto i = taken_back_.begin(); i != taken_back_.end(); ++i) {
    const int from = i->from;
    if (bring_back_again(std::move(*i), points)) continue;
    taken_back_.erase(taken_back_.begin(), i);
    return from;
  }
  taken_back_.clear();
  if (const std::optional<int> from = walk_and_bring_back(graph, points)) return from;
  add_returned_factors(before);
  return std::nullopt;
}

/// Adds the information of the stages about the landmarks that have just returned: the returns from position `first`
/// on.
void Factorisation::add_returned_factors(int first) {
  const int count = returns_.size() - first;
  if (count == 0) return;
  Eigen::MatrixXd R = Eigen::MatrixXd::Zero(root_.extent(), 3 * count);
  Eigen::VectorXd mean(3 * count);
  for (int i = 0; i < count; ++i) {
    const Return& one = returns_[first + i];
    R.block(0, 3 * i, one.R.rows(), 3) = one.R;
    mean.segment<3>(3 * i) = one.mean;
  }
  root_.add_factor(R, mean);
}

/// Returns a landmark that had already returned in a stage that is being redone. False if this is impossible.
bool Factorisation::bring_back_again(Return&& known, const LinearisationPoints& points) {
  auto& checkpoints = known.checkpoints;
  while (!checkpoints.empty() && checkpoints.back().stage > done_) checkpoints.pop_back();
  if (checkpoints.empty() || checkpoints.back().stage < done_) return false;
  const Return::Checkpoint& start = checkpoints.back();
  Walk walk(returns_, known.from, root_.stride(), 1);
  walk.x.topRows(start.x.rows()) = start.x;
  walk.square = start.square;
  walk.with_y = start.with_y;
  for (const auto& [id, sum] : start.sums) walk.pass.sum(id) = sum;
  walk.pass.resume(done_ + 1, known.g);
  Return* result = bring_back(std::move(known), walk);
  if (result == nullptr) return false;
  const Buffer now = increments_of_root(points);
  result->known = result->R.transpose() * as_vector(now.data(), static_cast<int>(result->R.rows())) - result->mean;
  return true;
}

/// Returns landmarks that are re-acquired for the first time since their elimination, in one walk. If some of them
/// cannot return, the result is the stage that must be redone.
std::optional<int> Factorisation::walk_and_bring_back(const FactorGraph& graph, const LinearisationPoints& points) {
  std::vector<Return> coming;
  std::vector<int> rows;
  std::ranges::sort(called_back_);
  called_back_.erase(std::unique(called_back_.begin(), called_back_.end()), called_back_.end());
  int first = done_ + 1;
  for (const int j : std::exchange(called_back_, {})) {
    if (!eliminated_at(j) || last_interval(j, graph) <= done_) continue;  // in the root, or not observed after all
    const Unknown place = *find_landmark(j);
    Return& one = coming.emplace_back();
    one.id = returns_.new_id();
    one.landmark = j;
    one.from = place.stage;
    one.delta_before = points.landmark_delta(j);
    rows.push_back(place.row);
    first = std::min(first, place.stage);
  }
  if (coming.empty()) return std::nullopt;
  const int count = static_cast<int>(coming.size()), columns = 3 * count, stride = root_.stride();
  Walk walk(returns_, first, stride, count);
  Buffer z;  // of all stages
  for (int k = first; k <= done_; ++k) {
    const Stage& stage = stages_[index(k)];
    const int pivots = stage.pivots();
    walk.pass.cross(k, walk.x.data(), stride);
    root_.follow_moves(stage.moved, walk.x.data(), stride, columns);
    for (int i = 0; i < count; ++i) {
      if (coming[index(i)].from == k) walk.x.block<3, 3>(rows[index(i)], 3 * i).setIdentity();
    }
    z.resize(z.size() + index(pivots * columns));
    double* const taken = z.data() + z.size() - index(pivots * columns);
    stage.eliminate(walk.x.data(), stride, taken, columns);
    walk.pass.add(stage.returned, taken, pivots);
    const auto Z = as_matrix(taken, pivots, columns, pivots);
    walk.square.noalias() += Z.transpose() * Z;
    int at = 0;
    for (const Conditional& c : stage.conditionals) {
      walk.with_y.noalias() += Z.middleRows(at, c.pivots).transpose() * as_vector(c.y.data(), c.pivots);
      at += c.pivots;
    }
    if (snapshots_.contains(k) && k >= done_ - kThinnedUpTo) keep_checkpoints(k, walk, coming);
  }
  std::vector<int> ids(coming.size(), -1);  // of the returned landmarks
  std::optional<int> failed;
  for (int i = 0; i < count; ++i) {
    const int id = coming[index(i)].id, from = coming[index(i)].from;
    Walk own(walk, i, from, root_.stride());  // the root may have grown for the landmarks before
    for (int e = 0; e < i; ++e) {
      if (ids[index(e)] >= 0) own.pass.sum(ids[index(e)]) = walk.square.block<3, 3>(3 * e, 3 * i);
    }
    if (bring_back(std::move(coming[index(i)]), own) != nullptr) {
      ids[index(i)] = id;
    } else {
      returns_.free_id(id);
      failed = std::min(from, failed.value_or(from));
    }
  }
  const double* taken = z.data();
  for (int k = first; k <= done_; ++k) {
    Stage& stage = stages_[index(k)];
    const int pivots = stage.pivots();
    for (int i = 0; i < count; ++i, taken += 3 * pivots) {
      if (ids[index(i)] >= 0 && coming[index(i)].from <= k) stage.returned.append(ids[index(i)], taken, pivots);
    }
  }
  return failed;
}

/// Stores the walk after stage k for each of its landmarks. Landmarks earlier in the order return earlier.
void Factorisation::keep_checkpoints(int k, Walk& walk, std::vector<Return>& coming) const {
  const int rows = stages_[index(k)].conditionals.back().extent, count = static_cast<int>(coming.size());
  for (int i = 0; i < count; ++i) {
    if (coming[index(i)].from > k) continue;
    const int column = 3 * i;
    Return::Checkpoint checkpoint{k,
                                  walk.x.block(0, column, rows, 3),
                                  walk.square.block<3, 3>(column, column),
                                  walk.with_y.segment<3>(column),
                                  {}};
    for (int e = returns_.first_after(k); e < returns_.size(); ++e) {
      if (returns_[e].from > k) continue;
      checkpoint.sums.emplace_back(returns_[e].id, walk.pass.sum(returns_[e].id).middleCols<3>(column));
    }
    for (int e = 0; e < i; ++e) {
      if (coming[index(e)].from > k) continue;
      checkpoint.sums.emplace_back(coming[index(e)].id, walk.square.block<3, 3>(3 * e, column));
    }
    coming[index(i)].checkpoints.push_back(std::move(checkpoint));
  }
}

Return* Factorisation::bring_back(Return&& result, Walk& walk) {
  const int j = result.landmark;
  result.before = done_ + 1;
  walk.pass.cross(result.before, walk.x.data(), static_cast<int>(walk.x.rows()));
  result.slot = root_.enter(j);
  Return* appended = returns_.append(std::move(result), walk, root_);
  if (appended != nullptr) landmarks_[index(j)].eliminated_at = -1;
  return appended;
}

Buffer Factorisation::increments_of_root(const LinearisationPoints& points) const {
  Buffer result(index(root_.stride()), 0.0);
  as_vector(result.data() + root_.row_of_state(done_), root_.state_size()) = points.state_delta(done_);
  for (int slot = 0; slot < root_.slots(); ++slot) {
    const int j = root_.occupant(slot);
    if (j >= 0) as_vector(result.data() + root_.row_of_slot(slot), 3) = points.landmark_delta(j);
  }
  return result;
}

}  // namespace evbench::smoother
