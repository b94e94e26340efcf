#include "frontends/str/registration/alignment.hpp"

#include <algorithm>
#include <cmath>

#include "core/geometry/solve_symmetric.hpp"

namespace evbench::str {

void Aligner::swap_targets(EventCloud& targets) {
  std::swap(targets_, targets);
  built_ = false;
  longest_ = 0.0F;
  left_ = top_ = 1e9F;
  right_ = bottom_ = -1e9F;
  for (std::size_t i = 0; i < targets_.size(); ++i) {
    longest_ = std::max(longest_, std::abs(targets_.t[i]));
    left_ = std::min(left_, targets_.x[i]);
    right_ = std::max(right_, targets_.x[i]);
    top_ = std::min(top_, targets_.y[i]);
    bottom_ = std::max(bottom_, targets_.y[i]);
  }
  if (options_.polarity) {
    kinds_ = targets_.on;
  } else {
    kinds_.assign(targets_.size(), 0);
  }
}

void Aligner::build(const Matrix3& A) {
  warp(targets_, A, target_x_, target_y_);
  grid_.build(target_x_, target_y_, targets_.t, kinds_, static_cast<float>(options_.cell / focal_length_));
  built_for_ = A;
  built_ = true;
}

bool Aligner::is_stale(const Matrix3& A) const {
  if (!built_) return true;
  const Eigen::Matrix3f change = (A - built_for_).cast<float>();
  const auto most = static_cast<float>(options_.stale / focal_length_);
  for (const float x : {left_, right_}) {
    for (const float y : {top_, bottom_}) {
      if (longest_ * flow(change, x, y).norm() > most) return true;
    }
  }
  return false;
}

const std::vector<Match>& Aligner::match(const EventCloud& queries, const Matrix3& A, double gate) {
  if (is_stale(A)) build(A);
  const Eigen::Matrix3f change = (A - built_for_).cast<float>();
  const auto reach = static_cast<float>(gate / focal_length_);
  warp(queries, A, query_x_, query_y_);
  matches_.clear();
  for (std::size_t i = 0; i < queries.size(); ++i) {
    const std::uint8_t kind = options_.polarity ? queries.on[i] : std::uint8_t{0};
    const auto found = grid_.nearest(query_x_[i], query_y_[i], kind, reach);
    if (!found) continue;
    const Eigen::Vector2f at(query_x_[i], query_y_[i]);
    const float x = target_x_[found->point], y = target_y_[found->point];
    const Eigen::Vector2f target = Eigen::Vector2f(x, y) + targets_.t[found->point] * flow(change, x, y);
    const Eigen::Vector2f difference = at - target;
    matches_.push_back(
        {static_cast<std::uint32_t>(i), found->point, found->cell, difference.squaredNorm(), at, difference});
  }
  return matches_;
}

double Aligner::mean_motion(const EventCloud& cloud, const Matrix3& A, double duration) const {
  if (cloud.size() == 0) return 0.0;
  const Eigen::Matrix3f M = A.cast<float>();
  double sum = 0.0;
  for (std::size_t i = 0; i < cloud.size(); ++i) sum += static_cast<double>(flow(M, cloud.x[i], cloud.y[i]).norm());
  return focal_length_ * duration * sum / static_cast<double>(cloud.size());
}

/// Collects the pull of each match on the motion A.
void Aligner::pull(const EventCloud& queries, const Matrix3& A) {
  const auto f = static_cast<float>(focal_length_);
  const auto noise = static_cast<float>(options_.edge_noise / focal_length_);
  const Eigen::Matrix3f drift = (A - built_for_).cast<float>();
  pulls_.clear();
  sorted_.clear();
  for (const Match& m : matches_) {
    Pull pull{m.difference, queries.t[m.query] - targets_.t[m.target], Eigen::Matrix2f::Identity(), m.at};
    if (options_.distance == AlignmentOptions::Distance::line) {
      const NeighbourGrid::Surroundings& s = grid_.surroundings(m.cell, noise);
      pull.difference = m.at - s.mean - s.time * flow(drift, s.mean.x(), s.mean.y());
      pull.between = queries.t[m.query] - s.time;
      pull.weight = s.weight;
    }
    pull.difference *= f;
    pull.squared = pull.difference.dot(pull.weight * pull.difference);
    pulls_.push_back(pull);
    sorted_.push_back(pull.squared);
  }
}

float Aligner::weight_of(const Pull& pull) const {
  return 1.0F / (1.0F + pull.squared / static_cast<float>(options_.robust_scale * options_.robust_scale));
}

double Aligner::chance_fit(const EventCloud& queries, const Matrix3& A) {
  constexpr float kCos = 0.5403F, kSin = 0.8415F;  // 1 rad: nothing that repeats in the image comes to lie on itself
  constexpr std::size_t kMost = 1000;
  if (queries.size() == 0) return 0.0;
  const EventCloud some = take_evenly(queries, kMost);
  warp(some, A, query_x_, query_y_);
  EventCloud elsewhere;
  for (std::size_t i = 0; i < some.size(); ++i) {
    elsewhere.add(kCos * query_x_[i] - kSin * query_y_[i], kSin * query_x_[i] + kCos * query_y_[i], 0.0F,
                  some.on[i] != 0);
  }
  match(elsewhere, A, options_.last_gate);
  pull(elsewhere, A);
  double fit = 0.0;
  for (const Pull& pull : pulls_) fit += static_cast<double>(weight_of(pull));
  return fit / static_cast<double>(elsewhere.size());
}

template <int P>
Alignment Aligner::align_with(const EventCloud& queries, MotionModel model, const Matrix3& start, double duration,
                              double gate) {
  using Hessian = Eigen::Matrix<double, P, P>;
  using Vector = Eigen::Matrix<double, P, 1>;
  std::array<Eigen::Matrix3f, P> G;
  for (int k = 0; k < P; ++k)
    G[static_cast<std::size_t>(k)] = generators(model)[static_cast<std::size_t>(k)].template cast<float>();
  const auto f = static_cast<float>(focal_length_);

  Alignment result{.A = start};
  const auto few = static_cast<std::size_t>(options_.first_queries);
  const bool in_two_steps = few > 0 && queries.size() > 2 * few;
  const EventCloud first = in_two_steps ? take_evenly(queries, few) : EventCloud();
  const EventCloud* asked = in_two_steps ? &first : &queries;
  for (; result.iterations < options_.iterations; ++result.iterations) {
    match(*asked, result.A, gate);
    if (matches_.size() < 2 * P) return result;
    pull(*asked, result.A);
    const auto last = static_cast<std::size_t>(options_.keep * static_cast<double>(sorted_.size() - 1));
    std::ranges::nth_element(sorted_, sorted_.begin() + static_cast<std::ptrdiff_t>(last));
    const float farthest = sorted_[last];

    Hessian H = Hessian::Zero();
    Vector g = Vector::Zero();
    double squares = 0.0, fit = 0.0;
    std::size_t counted = 0;
    for (const Pull& pull : pulls_) {
      const float weight = weight_of(pull);
      fit += static_cast<double>(weight);
      if (pull.squared > farthest) continue;
      Eigen::Matrix<float, 2, P> J;
      for (int k = 0; k < P; ++k) {
        J.col(k) = f * pull.between * flow(G[static_cast<std::size_t>(k)], pull.at.x(), pull.at.y());
      }
      const Eigen::Matrix<float, 2, P> WJ = weight * (pull.weight * J);
      H += (J.transpose() * WJ).template cast<double>();
      g += (WJ.transpose() * pull.difference).template cast<double>();
      squares += static_cast<double>(pull.squared);
      ++counted;
    }
    result.fit = fit / static_cast<double>(asked->size());
    result.residual = std::sqrt(squares / static_cast<double>(counted));
    const double damping = 1e-6 * H.trace() + 1e-12;
    const Vector step = solve_symmetric(H + damping * Hessian::Identity(), -g);
    if (!step.allFinite()) return result;
    Matrix3 change = Matrix3::Zero();
    for (int k = 0; k < P; ++k) change += step[k] * generators(model)[static_cast<std::size_t>(k)];
    result.A += change;
    const bool last_gate = gate <= options_.last_gate;
    gate = std::max(options_.last_gate, gate * options_.gate_shrinking);
    if (last_gate && mean_motion(*asked, change, duration) < options_.tolerance) {
      if (asked == &queries) {
        result.converged = true;
        ++result.iterations;
        break;
      }
      asked = &queries;
    }
  }
  return result;
}

Alignment Aligner::align(const EventCloud& queries, MotionModel model, const Matrix3& start, double duration,
                         double gate) {
  switch (model) {
    case MotionModel::rotation: return align_with<3>(queries, model, start, duration, gate);
    case MotionModel::translation: return align_with<2>(queries, model, start, duration, gate);
    case MotionModel::planar_4: return align_with<4>(queries, model, start, duration, gate);
    case MotionModel::planar_8: break;
  }
  return align_with<8>(queries, model, start, duration, gate);
}

}  // namespace evbench::str
