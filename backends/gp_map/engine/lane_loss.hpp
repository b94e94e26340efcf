#pragma once

#include "backends/gp_map/engine/lane_math.hpp"
#include "backends/gp_map/robust_loss.hpp"

namespace evbench::gp_map {

/// RobustLoss::value() and weight() of each lane.
struct LaneLoss {
  Lane value, weight;
};

inline LaneLoss loss_of(const RobustLoss& loss, Lane s) {
  const double width = loss.width(), w2 = width * width;
  switch (loss.kind()) {
    case RobustLoss::Kind::huber: {
      const Lane norm = sqrt(s);
      return {s <= w2 ? s : 2.0 * width * norm - w2, s <= w2 ? broadcast(1.0) : width / norm};
    }
    case RobustLoss::Kind::cauchy: return {w2 * log1p(s / w2), 1.0 / (1.0 + s / w2)};
    case RobustLoss::Kind::none: break;
  }
  return {s, broadcast(1.0)};
}

}  // namespace evbench::gp_map
