#include "backends/gp_map/health.hpp"

#include <fmt/format.h>

namespace evbench::gp_map {

void Health::observe(double from, double to, int landmarks) {
  if (lost()) return;
  if (landmarks >= options_.min_landmarks) {
    in_degraded_ = false;
    return;
  }
  if (!in_degraded_) {
    status_.degraded.push_back(
        {from, to, fmt::format("fewer than {} landmarks in view: the motion prior carries", options_.min_landmarks)});
    in_degraded_ = true;
  }
  DegradedSpan& span = status_.degraded.back();
  span.to = to;
  if (status_.state == RunState::ok) {
    status_.state = RunState::degraded;
    status_.reason = span.reason;
    status_.time = span.from;
  }
  if (span.to - span.from > options_.max_degraded) {
    lose(span.from, fmt::format("fewer than {} landmarks in view for more than {} s", options_.min_landmarks,
                                options_.max_degraded));
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
