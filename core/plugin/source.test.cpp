#include "core/plugin/source.hpp"

#include "core/testing/catch2.hpp"

using namespace evbench;

namespace {

/// Events with faults, as some drivers write them.
class Careless : public EventReader {
 public:
  Careless() { info_.width = info_.height = 10; }
  const StreamInfo& info() const override { return info_; }
  bool read(std::vector<Event>& events) override {
    events.clear();
    if (done_) return false;
    done_ = true;
    events = {{100, 1, 1, true},  {200, 2, 2, true},  {350, 3, 3, true}, {300, 4, 4, true},
              {310, 5, 5, false}, {400, 40, 6, true}, {500, 7, 7, true}, {501, 8, 8, false}};
    events.insert(events.begin(), 20, {100, 1, 1, true});  // so that the two invalid ones are few
    return true;
  }
  void seek(std::int64_t) override { done_ = false; }
  const Faults& faults() const override { return faults_; }

 private:
  StreamInfo info_;
  Faults faults_{"events", false};
  bool done_ = false;
};

class FakeSource : public Source {
 public:
  explicit FakeSource(bool has_events) : has_events_(has_events) { camera_.width = camera_.height = 10; }
  const Camera& camera() const override { return camera_; }
  TimeRange time_range() const override { return {0.0002, 0.0005}; }
  const PoseTrajectory& ground_truth() const override { return truth_; }
  std::unique_ptr<EventReader> all_events() const override {
    return has_events_ ? std::make_unique<Careless>() : nullptr;
  }

 private:
  bool has_events_;
  Camera camera_;
  PoseTrajectory truth_;
};

}  // namespace

TEST_CASE(
    "A front-end gets a source's events in order, within the sensor, and within the time range, both ends included") {
  const FakeSource source(true);
  for (int repetition = 0; repetition < 2; ++repetition) {  // each stream starts at the beginning
    std::vector<std::int64_t> times;
    const auto stream = source.events();
    for (std::vector<Event> events; stream->read(events);) {
      for (const Event& event : events) times.push_back(event.t);
    }
    CHECK(times == std::vector<std::int64_t>{200, 300, 310, 500});
  }
}

TEST_CASE("A source of tracks has no event stream") { CHECK(FakeSource(false).events() == nullptr); }
