#include "bench/micro/track_noise.hpp"

#include <Eigen/QR>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "core/smoother/factors.hpp"
#include "core/support/index.hpp"
#include "core/support/median.hpp"

namespace evbench {
namespace {

constexpr std::array kApart = {0.01, 0.02, 0.04, 0.07, 0.12, 0.2, 0.3, 0.45, 0.7, 1.0};  ///< [s]
constexpr double kMedianSquare = 1.38629;  ///< of a two-dimensional standard normal

/// Half mean square differences, by the time between.
struct Variogram {
  std::vector<double> apart, value;
};

Variogram variogram_of(const smoother::FactorGraph& graph) {
  struct Residual {
    double t;
    Vector2 value;
  };
  std::array<std::vector<double>, kApart.size()> squares, times;
  for (int j = 0; j < std::ssize(graph.landmarks); ++j) {
    std::vector<Residual> track;
    smoother::for_each_observation(graph, j, {}, [&](const GpInterval& interval, const smoother::Observation& z) {
      track.push_back(
          {z.t, smoother::reprojection_residual(interval, graph.landmarks[index(j)].position, z, graph.camera)});
    });
    for (std::size_t lag = 0; lag < kApart.size(); ++lag) {
      std::size_t late = 0;
      for (const Residual& early : track) {
        while (late < track.size() && track[late].t < early.t + kApart[lag]) ++late;
        if (late == track.size()) break;
        const double apart = track[late].t - early.t;
        if (apart > 1.5 * kApart[lag] + 0.02) continue;  // a hole
        squares[lag].push_back((track[late].value - early.value).squaredNorm());
        times[lag].push_back(apart);
      }
    }
  }
  Variogram result;
  for (std::size_t lag = 0; lag < kApart.size(); ++lag) {
    const double square = squares[lag].empty() ? 0.0 : median(squares[lag]);
    if (square == 0.0) continue;  // also of stationary tracks
    result.apart.push_back(median(times[lag]));
    result.value.push_back(0.5 * square / kMedianSquare);
  }
  return result;
}

}  // namespace

TrackNoise estimate_noise(const smoother::FactorGraph& graph) {
  const Variogram variogram = variogram_of(graph);
  const auto n = static_cast<Eigen::Index>(variogram.value.size());
  const Eigen::ArrayXd apart = Eigen::ArrayXd::Map(variogram.apart.data(), n);
  const Eigen::ArrayXd value = Eigen::ArrayXd::Map(variogram.value.data(), n);
  TrackNoise best;
  if (n < 3) return best;
  double least = std::numeric_limits<double>::infinity();
  constexpr double kShortest = 0.02, kLongest = 2.0, kStep = 1.05;  // [s]
  for (double time = kShortest; time <= kLongest; time *= kStep) {
    Eigen::MatrixX2d A(n, 2);  // relative errors
    A << 1.0 / value, (1.0 - (-apart / time).exp()) / value;
    Eigen::Vector2d squares = A.colPivHouseholderQr().solve(Eigen::VectorXd::Ones(n));
    for (const Eigen::Index negative : {0, 1}) {
      if (squares[negative] >= 0.0) continue;
      const Eigen::VectorXd other = A.col(1 - negative);
      squares[negative] = 0.0;
      squares[1 - negative] = other.sum() / other.squaredNorm();
    }
    const double error = (A * squares).array().operator-(1.0).matrix().squaredNorm();
    if (error < least) {
      least = error;
      best = {std::sqrt(squares[0]), std::sqrt(squares[1]), time};
    }
  }
  return best;
}

}  // namespace evbench
