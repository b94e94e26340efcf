#include "core/plugin/tracking_monitor.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace evbench {

void TrackingMonitor::observe(double from, double to, Support support, const std::string& reason) {
  if (lost()) return;
  has_map_ = true;
  if (support != Support::full) degrade(from, to, reason);
  in_degraded_ = support != Support::full;
  if (support != Support::none) {
    alone_since_.reset();
    return;
  }
  if (!alone_since_) alone_since_ = from;
  if (to - *alone_since_ > patience_) {
    lose(*alone_since_, fmt::format("{} for more than {} s", reason, patience_));
  }
}

void TrackingMonitor::degrade(double from, double to, const std::string& reason) {
  if (!in_degraded_) status_.degraded.push_back({from, to, reason});
  status_.degraded.back().to = to;
  if (status_.state != RunState::ok) return;
  status_.state = RunState::degraded;
  status_.reason = reason;
  status_.time = from;
}

void TrackingMonitor::recovered(double since) {
  if (in_degraded_) status_.degraded.back().to = std::max(status_.degraded.back().from, since);
  in_degraded_ = false;
  alone_since_.reset();
}

void TrackingMonitor::doubt(double from, double to, const std::string& reason) {
  if (lost()) return;
  in_degraded_ = false;
  degrade(from, to, reason);
}

void TrackingMonitor::lose(double t, const std::string& reason) {
  status_.state = RunState::lost;
  status_.reason = reason;
  status_.time = t;
}

void TrackingMonitor::fail(double t, const std::string& reason) {
  status_.state = RunState::failed;
  status_.reason = reason;
  status_.time = t;
}

TrackingState TrackingMonitor::state() const {
  if (lost()) return TrackingState::lost;
  if (!has_map_) return TrackingState::no_map;
  return in_degraded_ ? TrackingState::degraded : TrackingState::tracking;
}

}  // namespace evbench
