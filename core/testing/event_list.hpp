#pragma once

#include <algorithm>
#include <vector>

#include "core/events/reader.hpp"

namespace evbench::testing {

/// A recording of events in memory, which must outlive it.
class EventList : public EventReader {
 public:
  /// `width` and `height` of the sensor [px]; returns `chunk` events at a time.
  EventList(const std::vector<Event>& events, int width, int height, std::size_t chunk = 10'000)
      : events_(events), chunk_(chunk) {
    info_.width = width;
    info_.height = height;
  }
  const StreamInfo& info() const override { return info_; }
  bool read(std::vector<Event>& events) override {
    const std::size_t end = std::min(events_.size(), next_ + chunk_);
    events.assign(events_.begin() + static_cast<std::ptrdiff_t>(next_),
                  events_.begin() + static_cast<std::ptrdiff_t>(end));
    next_ = end;
    return !events.empty();
  }
  void seek(std::int64_t) override { next_ = 0; }
  const Faults& faults() const override { return faults_; }

 private:
  const std::vector<Event>& events_;
  std::size_t chunk_, next_ = 0;
  StreamInfo info_;
  Faults faults_{"events in memory", false};
};

}  // namespace evbench::testing
