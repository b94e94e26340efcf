#pragma once

#include "core/smoother/engine/lane_math.hpp"
#include "core/smoother/robust_loss.hpp"

namespace evbench::smoother {

/// RobustLoss::value() and weight() of each lane.
struct LaneLoss {
  Lane value, weight;
};

inline LaneLoss loss_of(const RobustLoss& loss, Lane s) {
  const double width = loss.width(), w2 = width * width, share = loss.share();
  switch (loss.kind()) {
    case RobustLoss::Kind::huber: {
      const Lane norm = sqrt(s);
      return {share * (s <= w2 ? s : 2.0 * width * norm - w2), share * (s <= w2 ? broadcast(1.0) : width / norm)};
    }
    case RobustLoss::Kind::cauchy: return {share * w2 * log1p(s / w2), share / (1.0 + s / w2)};
    case RobustLoss::Kind::none: break;
  }
  return {share * s, broadcast(share)};
}

}  // namespace evbench::smoother
