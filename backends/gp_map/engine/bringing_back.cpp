#include <algorithm>
#include <iterator>
#include <limits>
#include <utility>

#include "backends/gp_map/engine/factorisation.hpp"

// Landmarks that come back into the root after they were eliminated: the mathematics is in returns.hpp and engine.md.
namespace evbench::gp_map {

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
    i = returns_.size();  // more returns may be concerned
  }
  return first;
}

/// Landmarks that had come back after the last stage that is still done will come back now. Those that are still in the
/// root now, or that have not been seen, will not leave it: if they have moved since they came back, all stages are to
/// be redone that know them. Returns the oldest of these.
int Factorisation::take_back_returns(const FactorGraph& graph) {
  std::vector<Return> taken = returns_.take_after(done_);
  std::ranges::move(taken_back_, std::back_inserter(taken));
  taken_back_.clear();
  int oldest = std::numeric_limits<int>::max();
  for (auto i = taken.rbegin(); i != taken.rend(); ++i) {
    landmarks_[index(i->landmark)].eliminated_at = i->from;
    if (i->from <= done_) continue;
    const auto same = std::find_if(i + 1, taken.rend(), [&](const Return& r) { return r.landmark == i->landmark; });
    Return* earlier = same != taken.rend() ? &*same : returns_.last_of(i->landmark);
    if (earlier != nullptr) earlier->offset += i->offset;
    returns_.free_id(i->id);
    if (same != taken.rend() || i->offset.isZero(0.0)) continue;
    const auto& seen = graph.landmarks[index(i->landmark)].intervals;
    if (earlier != nullptr)
      oldest = std::min(oldest, earlier->before);
    else if (!seen.empty())
      oldest = std::min(oldest, seen.front());
  }
  std::ranges::copy_if(std::make_move_iterator(taken.begin()), std::make_move_iterator(taken.end()),
                       std::back_inserter(taken_back_), [&](const Return& r) { return r.from <= done_; });
  return oldest;
}

/// Brings landmarks back into the root as it is now. If that can't be done, the stage that has to be redone instead.
std::optional<int> Factorisation::bring_all_back(const FactorGraph& graph, const LinearisationPoints& points) {
  for (auto i = taken_back_.begin(); i != taken_back_.end(); ++i) {
    const int from = i->from;
    if (bring_back_again(std::move(*i), points)) continue;
    taken_back_.erase(taken_back_.begin(), i);
    return from;
  }
  taken_back_.clear();
  while (!called_back_.empty()) {
    const int j = called_back_.back();
    called_back_.pop_back();
    const std::optional<int> from = eliminated_at(j);
    if (!from || last_interval(j, graph) <= done_) continue;  // it is in the root, or its observations were taken back
    if (!walk_and_bring_back(j, points)) return from;
  }
  return std::nullopt;
}

/// A landmark that had come back in a stage that is being redone.
bool Factorisation::bring_back_again(Return&& known, const LinearisationPoints& points) {
  auto& checkpoints = known.checkpoints;
  while (!checkpoints.empty() && checkpoints.back().stage > done_) checkpoints.pop_back();
  if (checkpoints.empty() || checkpoints.back().stage < done_) return false;
  const Return::Checkpoint& start = checkpoints.back();
  Walk walk(returns_, known.from, root_.stride());
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

/// A landmark that comes back for the first time since it was eliminated.
bool Factorisation::walk_and_bring_back(int j, const LinearisationPoints& points) {
  const auto [from, row] = *find_landmark(j);
  Return result;
  result.id = returns_.new_id();
  result.landmark = j;
  result.from = from;
  result.delta_before = points.landmark_delta(j);
  const int stride = root_.stride();
  Walk walk(returns_, from, stride);
  walk.x.middleRows<3>(row).setIdentity();
  Buffer z;
  for (int k = from; k <= done_; ++k) {
    walk.pass.cross(k, walk.x.data(), stride);
    Stage& stage = stages_[index(k)];
    const int pivots = stage.pivots();
    z.resize(3 * index(pivots));
    stage.eliminate(walk.x.data(), stride, z.data(), 3);
    walk.pass.add(stage.returned, z.data(), pivots);
    const auto Z = as_matrix(z.data(), pivots, 3, pivots);
    walk.square.noalias() += Z.transpose() * Z;
    int at = 0;
    for (const Conditional& c : stage.conditionals) {
      walk.with_y.noalias() += Z.middleRows(at, c.pivots).transpose() * as_vector(c.y.data(), c.pivots);
      at += c.pivots;
    }
    stage.returned.append(result.id, z.data(), pivots);
    if (snapshots_.contains(k) && k >= done_ - kThinnedUpTo) keep_checkpoint(k, walk, result);
  }
  if (bring_back(std::move(result), walk) != nullptr) return true;
  returns_.free_id(result.id);
  return false;
}

void Factorisation::keep_checkpoint(int k, Walk& walk, Return& result) const {
  const int rows = stages_[index(k)].conditionals.back().extent;
  result.checkpoints.push_back({k, walk.x.topRows(rows), walk.square, walk.with_y, {}});
  auto& sums = result.checkpoints.back().sums;
  for (int i = returns_.first_after(k); i < returns_.size(); ++i) {
    if (returns_[i].from <= k) sums.emplace_back(returns_[i].id, walk.pass.sum(returns_[i].id));
  }
}

Return* Factorisation::bring_back(Return&& result, Walk& walk) {
  const int j = result.landmark;
  result.before = done_ + 1;
  walk.pass.cross(result.before, walk.x.data(), static_cast<int>(walk.x.rows()));
  result.slot = root_.enter(j);
  Return* appended = returns_.append(std::move(result), walk, root_.extent());
  if (appended == nullptr) return nullptr;
  landmarks_[index(j)].eliminated_at = -1;
  root_.add_factor(appended->R, appended->mean);
  return appended;
}

Buffer Factorisation::increments_of_root(const LinearisationPoints& points) const {
  Buffer result(index(root_.stride()), 0.0);
  as_vector(result.data() + Root::row_of_state(done_), 12) = points.state_delta(done_);
  for (int slot = 0; slot < root_.slots(); ++slot) {
    const int j = root_.occupant(slot);
    if (j >= 0) as_vector(result.data() + Root::row_of_slot(slot), 3) = points.landmark_delta(j);
  }
  return result;
}

}  // namespace evbench::gp_map
