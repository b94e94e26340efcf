#include <algorithm>
#include <cmath>
#include <iterator>

#include "core/process/json_lines.hpp"

namespace evbench::process {
namespace {

template <class... Values>
void put(Line& line, fmt::format_string<Values...> format, Values&&... values) {
  fmt::format_to(std::back_inserter(line), format, std::forward<Values>(values)...);
}

/// Writes a list; `write` writes an item.
template <class Items, class Write>
void put_list(Line& line, const Items& items, Write write) {
  const char* separator = "[";
  for (const auto& item : items) {
    put(line, "{}", separator);
    write(item);
    separator = ",";
  }
  put(line, "{}", items.empty() ? "[]" : "]");
}

void put_numbers(Line& line, const double* values, Eigen::Index count) {
  for (Eigen::Index i = 0; i < count; ++i) put(line, "{}{}", i == 0 ? "" : ",", values[i]);
}

bool is_finite(const UndistortedObservation& z) {
  return std::isfinite(z.t) && z.pixel.allFinite() && z.noise.is_valid();
}

void put_newest(Line& line, const ControlState& state) {
  const Eigen::Quaterniond& q = state.T.q;
  put(line, ",\"newest\":[{},", state.t);
  put_numbers(line, state.T.p.data(), 3);
  put(line, ",{},{},{},{},", q.x(), q.y(), q.z(), q.w());
  put_numbers(line, state.velocity.data(), 6);
  put(line, "]");
}

}  // namespace

void write_events(Line& line, std::span<const Event> events) {
  // Divided, not multiplied by 1e-6, so that 12345 µs are written as 0.012345 s.
  put_list(line, events,
           [&](const Event& e) { put(line, "[{},{},{},{}]", static_cast<double>(e.t) / 1e6, e.x, e.y, e.on ? 1 : 0); });
}

int write_batch(Line& line, const UndistortedBatch& batch) {
  std::vector<UndistortedObservation> finite;
  finite.reserve(batch.observations.size());
  std::ranges::copy_if(batch.observations, std::back_inserter(finite), is_finite);
  put(line, "\"until\":{},\"observations\":", batch.until);
  put_list(line, finite, [&](const UndistortedObservation& z) {
    put(line, "[{},{},{},{},{}]", z.track, z.t, z.pixel.x(), z.pixel.y(), z.noise.sigma());
  });
  if (!std::ranges::all_of(finite, [](const UndistortedObservation& z) { return z.noise.is_isotropic(); })) {
    put(line, ",\"covariances\":");
    put_list(line, finite, [&](const UndistortedObservation& z) {
      put(line, "[{},{},{}]", z.noise.xx(), z.noise.xy(), z.noise.yy());
    });
  }
  put(line, ",\"ended\":");
  put_list(line, batch.ended, [&](const TrackEnd& end) { put(line, "[{},{}]", end.track, end.t); });
  return static_cast<int>(batch.observations.size() - finite.size());
}

void write_feedback(Line& line, const Feedback& feedback) {
  put(line, "{{\"t\":{},\"state\":\"{}\",\"world\":{}", feedback.t, name_of(feedback.state), feedback.world);
  const bool usable = feedback.newest && feedback.newest->T.p.allFinite() &&
                      feedback.newest->T.q.coeffs().allFinite() && feedback.newest->velocity.allFinite();
  if (usable) put_newest(line, *feedback.newest);
  if (usable && feedback.covariance && feedback.covariance->allFinite()) {
    put(line, ",\"covariance\":[");
    put_numbers(line, feedback.covariance->data(), 144);  // symmetric: row-major equals column-major
    put(line, "]");
  }
  put(line, ",\"outliers\":");
  put_list(line, feedback.outliers, [&](TrackId track) { put(line, "{}", track); });
  std::vector<ExpectedFeature> finite;
  std::ranges::copy_if(feedback.expected, std::back_inserter(finite), [](const ExpectedFeature& f) {
    return f.position.allFinite() && f.pixel.allFinite() && f.covariance.allFinite();
  });
  put(line, ",\"expected\":");
  put_list(line, finite, [&](const ExpectedFeature& f) {
    put(line, "[{},{},{},{},{},{},{},{},{}]", f.track, f.position.x(), f.position.y(), f.position.z(), f.pixel.x(),
        f.pixel.y(), f.covariance(0, 0), f.covariance(0, 1), f.covariance(1, 1));
  });
  put(line, "}}");
}

}  // namespace evbench::process
