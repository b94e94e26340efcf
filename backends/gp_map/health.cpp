#include "backends/gp_map/health.hpp"

#include <fmt/format.h>

namespace evbench::gp_map {

void Health::observe(double from, double to, int landmarks) {
  if (lost()) return;
  watch_degraded(from, to, landmarks);
  if (landmarks >= options_.lost_landmarks) {
    alone_since_.reset();
    return;
  }
  if (!alone_since_) alone_since_ = from;
  if (to - *alone_since_ > options_.patience) {
    lose(*alone_since_,
         fmt::format("fewer than {} landmarks in view for more than {} s", options_.lost_landmarks, options_.patience));
  }
}

void Health::watch_degraded(double from, double to, int landmarks) {
  if (landmarks >= options_.min_landmarks) {
    in_degraded_ = false;
    return;
  }
  if (!in_degraded_) {
    status_.degraded.push_back(
        {from, to, fmt::format("fewer than {} landmarks in view: the motion prior carries", options_.min_landmarks)});
    in_degraded_ = true;
  }
  status_.degraded.back().to = to;
  if (status_.state == RunState::ok) {
    status_.state = RunState::degraded;
    status_.reason = status_.degraded.back().reason;
    status_.time = from;
  }
}

void Health::lose(double t, const std::string& reason) {
  status_.state = RunState::lost;
  status_.reason = reason;
  status_.time = t;
}

void Health::fail(double t, const std::string& reason) {
  status_.state = RunState::failed;
  status_.reason = reason;
  status_.time = t;
}

}  // namespace evbench::gp_map
