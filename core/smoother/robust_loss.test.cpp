#include "core/smoother/robust_loss.hpp"

#include <vector>

#include "core/geometry/types.hpp"
#include "core/simulation/random.hpp"
#include "core/testing/catch2.hpp"

using namespace evbench;
using namespace evbench::smoother;

TEST_CASE("A loss's weights and its information share give the covariance of an estimate") {
  for (const RobustLoss& loss : {RobustLoss(RobustLoss::Kind::cauchy, 2.0), RobustLoss(RobustLoss::Kind::cauchy, 1.0),
                                 RobustLoss(RobustLoss::Kind::huber, 1.0), RobustLoss()}) {
    CAPTURE(static_cast<int>(loss.kind()), loss.width());
    constexpr int kTrials = 4000, kObservations = 50, kIterations = 20;
    Random random(1);
    double squared_error = 0.0, weights = 0.0;
    for (int trial = 0; trial < kTrials; ++trial) {  // a point in the plane, seen with normal errors, is at zero
      std::vector<Vector2> seen;
      for (int i = 0; i < kObservations; ++i) seen.push_back(random.normal2());
      Vector2 estimate = Vector2::Zero();
      double sum = 0.0;
      for (int iteration = 0; iteration < kIterations; ++iteration) {
        Vector2 weighted = Vector2::Zero();
        sum = 0.0;
        for (const Vector2& z : seen) {
          const double weight = loss.weight((z - estimate).squaredNorm());
          weighted += weight * z;
          sum += weight;
        }
        estimate = weighted / sum;
      }
      squared_error += estimate.squaredNorm() / (2.0 * kTrials);
      weights += sum / kTrials;
    }
    CHECK(squared_error == Approx(loss.information_share() / weights).epsilon(0.05));
  }
  CHECK(RobustLoss().information_share() == Approx(1.0));
  CHECK(RobustLoss(RobustLoss::Kind::cauchy, 2.0).information_share() == Approx(0.79).margin(0.005));
}
