#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "core/motion/wnoa.hpp"
#include "core/smoother/engine/observation_sums.hpp"
#include "core/smoother/factors.hpp"
#include "core/support/index.hpp"

// Lanes run over landmarks: kLanes of them, with similar numbers of observations in the interval, are processed
// together, the i-th observation of each at once (weight 0 if one has fewer). Terms that a landmark's observations
// share stay in lanes of registers until they are complete, and only the result is transposed.
//
// With m = T_0⁻¹ l and ξ = a ϖ_0 + b ξ_1 + c w_1 (with Singer's prior + d ϖ_0' + e c_1) a residual is a function of
// (m, ξ) alone, e = whitened π(Exp(−ξ) m) − z. With G = ∂e/∂ξ the block of each pair of y = (ϖ_0, ξ_1, w_1, ...) is a
// multiple of GᵀG, and the first pose acts through m alone: δm = R_0ᵀ δl + [m^, −I] δT_0. Only once an interval these
// local coordinates are mapped to the increments of both states.
namespace evbench::smoother {
namespace {

using namespace lanes;  // NOLINT: this file and that header are one algorithm

/// rows × [m^, −I]: turns a derivative with respect to m into one with respect to δT_0.
template <std::size_t N>
std::array<std::array<Lane, 6>, N> through_first_pose(const std::array<std::array<Lane, 3>, N>& rows, const Lane3& m) {
  std::array<std::array<Lane, 6>, N> result;
  for (std::size_t r = 0; r < N; ++r) {
    const Lane3 turned = cross({rows[r][0], rows[r][1], rows[r][2]}, m);  // vᵀ m^ = (v × m)ᵀ
    result[r] = {turned.x, turned.y, turned.z, -rows[r][0], -rows[r][1], -rows[r][2]};
  }
  return result;
}

/// The coupling of each lane's landmark in world coordinates and to the increments of both states.
template <int Orders>
void write_couplings(const LandmarkSums<Orders>& landmark, const std::array<std::array<Lane, 6>, 3>& mT,
                     const Matrix3& R0, const GpInterval::Derivatives& map,
                     const std::array<IntervalLinearisation::Coupling*, kLanes>& couplings) {
  constexpr Eigen::Index kState = 6 * Orders;
  const auto rotate = [&](const std::array<Lane, 3>& v, std::size_t r) {
    const auto i = static_cast<Eigen::Index>(r);
    return R0(i, 0) * v[0] + R0(i, 1) * v[1] + R0(i, 2) * v[2];
  };
  const auto scatter = [&](Lane value, auto member) {
    for (int i = 0; i < kLanes; ++i) {
      if (couplings[index(i)] != nullptr) member(*couplings[index(i)]) = value[i];
    }
  };
  const auto& h = landmark.mm;
  const std::array<std::array<Lane, 3>, 3> mm = {{{h[0][0], h[1][0], h[2][0]},  //
                                                  {h[1][0], h[1][1], h[2][1]},
                                                  {h[2][0], h[2][1], h[2][2]}}};
  std::array<std::array<Lane, 3>, 3> Rmm;  // R mm
  for (std::size_t r = 0; r < 3; ++r) {
    for (std::size_t c = 0; c < 3; ++c) Rmm[r][c] = rotate(mm[c], r);
  }
  for (std::size_t r = 0; r < 3; ++r) {
    const auto row = static_cast<Eigen::Index>(r);
    scatter(rotate(landmark.gradient, r), [&](auto& c) -> double& { return c.gradient(row); });
    for (std::size_t c = 0; c < 3; ++c) {
      const auto column = static_cast<Eigen::Index>(c);
      scatter(rotate(Rmm[r], c), [&](auto& to) -> double& { return to.landmark_landmark(row, column); });
    }
    const auto turned = [&](std::size_t i) {
      return rotate({landmark.my[0][i], landmark.my[1][i], landmark.my[2][i]}, r);
    };
    std::array<Lane, 6 * Orders> end;  // (ξ_1, w_1, c_1)
    for (std::size_t i = 0; i < 6; ++i) {
      const auto column = static_cast<Eigen::Index>(i);
      scatter(turned(i), [&](auto& c) -> double& { return c.landmark_states(row, 6 + column); });
      if constexpr (Orders == 3) {
        scatter(turned(18 + i), [&](auto& c) -> double& { return c.landmark_states(row, 12 + column); });
        end[12 + i] = turned(24 + i);
      }
    }
    for (std::size_t i = 0; i < 12; ++i) end[i] = turned(6 + i);
    for (std::size_t i = 0; i < 6; ++i) {
      const auto column = static_cast<Eigen::Index>(i);
      Lane T0 = rotate({mT[0][i], mT[1][i], mT[2][i]}, r);
      Lane T1{}, v1{};
      for (std::size_t k = 0; k < 6; ++k) {
        const auto at = static_cast<Eigen::Index>(k);
        T0 += end[k] * map.xi1_T0(at, column) + end[6 + k] * map.w1_T0(at, column);
        T1 += end[k] * map.xi1_T1(at, column) + end[6 + k] * map.w1_T1(at, column);
        v1 += end[6 + k] * map.w1_v1(at, column);
        if constexpr (Orders == 3) {
          T0 += end[12 + k] * map.c1_T0(at, column);
          T1 += end[12 + k] * map.c1_T1(at, column);
          v1 += end[12 + k] * map.c1_v1(at, column);
        }
      }
      scatter(T0, [&](auto& c) -> double& { return c.landmark_states(row, column); });
      scatter(T1, [&](auto& c) -> double& { return c.landmark_states(row, kState + column); });
      scatter(v1, [&](auto& c) -> double& { return c.landmark_states(row, kState + 6 + column); });
      if constexpr (Orders == 3) {
        Lane a1{};
        for (std::size_t k = 0; k < 6; ++k) a1 += end[12 + k] * map.c1_a1(static_cast<Eigen::Index>(k), column);
        scatter(a1, [&](auto& c) -> double& { return c.landmark_states(row, kState + 12 + column); });
      }
    }
  }
}

/// Adds the first pose's part to the interval's sums, computed from the landmark's.
template <int Orders>
void add_first_pose(const LandmarkSums<Orders>& landmark, const std::array<std::array<Lane, 6>, 3>& mT, const Lane3& m,
                    IntervalSums<Orders>& sums) {
  constexpr std::size_t kRows = IntervalSums<Orders>::kRows;
  std::array<std::array<Lane, 3>, 6> Tm;
  for (std::size_t i = 0; i < 6; ++i) Tm[i] = {mT[0][i], mT[1][i], mT[2][i]};
  const auto TT = through_first_pose(Tm, m);
  std::size_t n = 0;
  for (std::size_t i = 0; i < 6; ++i) {
    for (std::size_t j = 0; j <= i; ++j, ++n) sums.TT[n] += TT[i][j];
  }
  std::array<std::array<Lane, 3>, kRows> ym;
  for (std::size_t i = 0; i < kRows; ++i) ym[i] = {landmark.my[0][i], landmark.my[1][i], landmark.my[2][i]};
  const auto yT = through_first_pose(ym, m);
  for (std::size_t i = 0; i < kRows; ++i) {
    for (std::size_t j = 0; j < 6; ++j) sums.yT[i][j] += yT[i][j];
  }
  const auto g = through_first_pose(std::array<std::array<Lane, 3>, 1>{landmark.gradient}, m);
  for (std::size_t j = 0; j < 6; ++j) sums.gradient_T[j] += g[0][j];
}

template <int Orders, Range range>
void add_landmarks(const Shared<Orders>& shared, const IntervalInput& in, const Matrix3& R0,
                   const GpInterval::Derivatives& map, std::span<const int> order, IntervalSums<Orders>& sums,
                   IntervalLinearisation& result) {
  const auto& groups = in.observations.groups();
  const Observation* all = in.observations.all().data();
  for (std::size_t first = 0; first < order.size(); first += kLanes) {
    std::array<IntervalLinearisation::Coupling*, kLanes> couplings{};
    std::array<const Observation*, kLanes> next{};
    std::array<int, kLanes> count{};
    Lane3 m;
    m.z += 1.0;
    for (std::size_t i = 0; i < kLanes && first + i < order.size(); ++i) {
      const std::size_t g = index(order[first + i]);
      const auto& group = groups[g];
      couplings[i] = &result.couplings[g];
      couplings[i]->landmark = group.landmark;
      couplings[i]->landmark_states.resize(3, 12 * Orders);
      next[i] = all + group.begin;
      count[i] = group.end - group.begin;
      const Vector3 local = R0.transpose() * (in.positions[g] - in.state0.T.p);
      m.x[i] = local.x();
      m.y[i] = local.y();
      m.z[i] = local.z();
    }
    LandmarkSums<Orders> landmark;
    for (int n = 0; n < count[0]; ++n) {  // lane 0 has the most
      Measured z(shared.interval.t0);
      for (std::size_t i = 0; i < kLanes; ++i) {
        if (n < count[i]) z.set(i, *next[i]++);
      }
      add_observation<range, Orders>(shared, m, z, landmark, sums);
    }
    const auto& h = landmark.mm;
    const auto mT = through_first_pose(
        std::array<std::array<Lane, 3>, 3>{
            {{h[0][0], h[1][0], h[2][0]}, {h[1][0], h[1][1], h[2][1]}, {h[2][0], h[2][1], h[2][2]}}},
        m);
    add_first_pose(landmark, mT, m, sums);
    write_couplings(landmark, mT, R0, map, couplings);
    for (std::size_t i = 0; i < kLanes; ++i) {
      if (couplings[i] == nullptr) continue;
      couplings[i]->error = {landmark.error[i], count[i], static_cast<int>(landmark.behind[i])};
    }
  }
}

/// Normal equations in the local coordinates: δT_0, then δϖ_0 (and δϖ_0') of the begin, then δξ_1, δw_1 (and δc_1) of
/// the end. The first half are increments of the first state.
template <int Orders>
struct LocalSystem {
  static constexpr int kState = 6 * Orders, kBegin = kState - 6;  ///< rows of the end, and of the begin without δT_0
  using End = Eigen::Matrix<double, kState, kState>;

  Eigen::Matrix<double, 2 * kState, 2 * kState> H;
  Eigen::Matrix<double, 2 * kState, 1> g;

  explicit LocalSystem(const IntervalSums<Orders>& sums) {
    constexpr Eigen::Index kTerms = IntervalSums<Orders>::kTerms;
    std::size_t n = 0;
    for (Eigen::Index i = 0; i < 6; ++i) {
      g(i) = sum(sums.gradient_T[index(i)]);
      for (Eigen::Index j = 0; j <= i; ++j, ++n) {
        H(i, j) = H(j, i) = sum(sums.TT[n]);
        std::size_t pair = 0;
        for (Eigen::Index p = 0; p < kTerms; ++p) {
          for (Eigen::Index q = 0; q <= p; ++q, ++pair) {
            const double value = sum(sums.yy[pair][n]);
            const Eigen::Index r = row_of(p), c = row_of(q);
            H(r + i, c + j) = H(r + j, c + i) = H(c + j, r + i) = H(c + i, r + j) = value;
          }
        }
      }
    }
    for (Eigen::Index term = 0; term < kTerms; ++term) {
      for (Eigen::Index i = 0; i < 6; ++i) {
        const Eigen::Index row = row_of(term) + i, at = 6 * term + i;
        g(row) = sum(sums.gradient_y[index(at)]);
        for (Eigen::Index j = 0; j < 6; ++j) H(row, j) = H(j, row) = sum(sums.yT[index(at)][index(j)]);
      }
    }
  }

  /// The residual is linear in the local coordinates, J = [0, F, I]: the end less its expectation from the begin.
  /// Returns its cost.
  double add_motion_prior(const GpInterval& interval, const Vector6& qc) {
    const End W = information(interval, qc);
    const Eigen::Matrix<double, kState, 1> e = interval.prior_residual();
    const Eigen::Matrix<double, kState, 1> We = W * e;
    const Eigen::Matrix<double, kState, kBegin> WF = times_F(interval, W);
    H.template block<kBegin, kBegin>(6, 6) += times_F(interval, WF.transpose().eval()).transpose();
    H.template block<kState, kBegin>(kState, 6) += WF;
    H.template block<kBegin, kState>(6, kState) += WF.transpose();
    H.template bottomRightCorner<kState, kState>() += W;
    g.template segment<kBegin>(6) += times_F(interval, We.transpose().eval()).transpose();
    g.template tail<kState>() += We;
    return 0.5 * e.dot(We);
  }

 private:
  /// The row of a term of y = (ϖ_0, ξ_1, w_1, ϖ_0', c_1).
  static Eigen::Index row_of(Eigen::Index term) {
    constexpr std::array<Eigen::Index, 5> kOrder = {0, Orders - 1, Orders, 1, 4};
    return 6 + 6 * kOrder[index(term)];
  }

  static End information(const GpInterval& interval, const Vector6& qc) {
    if constexpr (Orders == 2) return wnoa::process_information(interval.dt(), qc);
    const Eigen::MatrixXd axis = interval.prior_information_of_axis();
    End W = End::Zero();
    for (int r = 0; r < Orders; ++r) {
      for (int c = 0; c < Orders; ++c) W.template block<6, 6>(6 * r, 6 * c).diagonal() = axis(r, c) * qc.cwiseInverse();
    }
    return W;
  }

  /// M F, where F = −Φ without its column of the pose: (−Δt, −1) for ϖ_0 and WNOA.
  template <class Derived>
  static auto times_F(const GpInterval& interval, const Eigen::MatrixBase<Derived>& M) {
    Eigen::Matrix<double, Derived::RowsAtCompileTime, kBegin> result;
    result.template leftCols<6>() = -interval.dt() * M.template leftCols<6>() - M.template middleCols<6>(6);
    if constexpr (Orders == 3) {
      const Vector3 decay = singer::transition(interval.dt(), interval.singer_rate()).col(2);
      result.template rightCols<6>() = -decay[0] * M.template leftCols<6>() - decay[1] * M.template middleCols<6>(6) -
                                       decay[2] * M.template rightCols<6>();
    }
    return result;
  }
};

/// From the local coordinates to the increments of both states: the first half stays, the end is mapped.
template <int Orders>
void map_to_states(const LocalSystem<Orders>& local, const GpInterval::Derivatives& d, IntervalLinearisation& result) {
  constexpr int kState = 6 * Orders, kPair = 2 * kState;
  using Map = Eigen::Matrix<double, kState, kPair>;
  Map map = Map::Zero();
  const auto set = [&map](int r, int c, const Matrix6& block) { map.template block<6, 6>(r, c) = block; };
  set(0, 0, d.xi1_T0);
  set(0, kState, d.xi1_T1);
  set(6, 0, d.w1_T0);
  set(6, kState, d.w1_T1);
  set(6, kState + 6, d.w1_v1);
  if constexpr (Orders == 3) {
    set(12, 0, d.c1_T0);
    set(12, kState, d.c1_T1);
    set(12, kState + 6, d.c1_v1);
    set(12, kState + 12, d.c1_a1);
  }
  Map half;
  half.noalias() = 0.5 * local.H.template bottomRightCorner<kState, kState>() * map;
  half.template leftCols<kState>() += local.H.template bottomLeftCorner<kState, kState>();
  Eigen::Matrix<double, kPair, kPair> mixed;
  mixed.noalias() = map.transpose() * half;
  result.states = mixed + mixed.transpose();
  result.states.template topLeftCorner<kState, kState>() += local.H.template topLeftCorner<kState, kState>();
  result.gradient.noalias() = map.transpose() * local.g.template tail<kState>();
  result.gradient.template head<kState>() += local.g.template head<kState>();
}

/// Adds the gradient of the expansion −c log s = c log Σ 1/d_j. Its curvature is negligible against the observations'.
void add_expansion(const IntervalInput& in, IntervalLinearisation& result) {
  if (in.expansion == 0.0 || in.positions.empty()) return;
  const SE3& T = in.state0.T;
  double nearness = 0.0;
  for (const Vector3& position : in.positions) nearness += 1.0 / (position - T.p).norm();
  for (std::size_t j = 0; j < in.positions.size(); ++j) {
    const Vector3 ray = in.positions[j] - T.p;
    const Vector3 force = in.expansion / nearness / std::pow(ray.norm(), 3.0) * ray;
    result.couplings[j].gradient -= force;
    result.gradient.segment<3>(3) += T.R().transpose() * force;
  }
  result.cost += in.expansion * std::log(nearness / static_cast<double>(in.positions.size()));
}

}  // namespace

void linearise_interval(const IntervalInput& in, IntervalLinearisation& result) {
  const GpInterval interval(in.state0, in.state1, in.motion_prior);
  const Matrix3 R0 = interval.T0().R();
  const GpInterval::Derivatives derivatives = interval.derivatives();
  const auto& groups = in.observations.groups();
  result.couplings.resize(groups.size());
  thread_local std::vector<int> order;  // landmarks with the most observations first
  order.resize(groups.size());
  std::iota(order.begin(), order.end(), 0);
  std::ranges::stable_sort(order, [&](int a, int b) {
    const auto& ga = groups[index(a)];
    const auto& gb = groups[index(b)];
    return ga.end - ga.begin > gb.end - gb.begin;
  });
  with_kind_of(interval, [&]<int orders, Range range>() {
    const Shared<orders> shared{in.loss, in.camera, Interval<orders>(interval)};
    IntervalSums<orders> sums;
    add_landmarks<orders, range>(shared, in, R0, derivatives, order, sums, result);
    LocalSystem<orders> local(sums);
    result.cost = sum(sums.cost) + local.add_motion_prior(interval, in.qc);
    map_to_states(local, derivatives, result);
  });
  add_expansion(in, result);
}

void linearise_interval(const FactorGraph& graph, int k, IntervalLinearisation& result) {
  const IntervalObservations& observations = graph.intervals[index(k)];
  thread_local std::vector<Vector3> positions;
  positions.clear();
  for (const auto& group : observations.groups()) {
    positions.push_back(graph.landmarks[index(group.landmark)].position);
  }
  linearise_interval({graph.camera, graph.loss, graph.motion_prior, graph.qcs[index(k)], graph.expansions[index(k)],
                      graph.states[index(k - 1)], graph.states[index(k)], observations, positions},
                     result);
}

}  // namespace evbench::smoother
