#pragma once

#include <memory>
#include <vector>

#include "core/events/reader.hpp"
#include "core/simulation/events/brightness.hpp"
#include "core/simulation/events/pixel_model.hpp"
#include "core/simulation/time_spans.hpp"

namespace evbench {

struct SimulatorOptions {
  SensorOptions sensor;
  double time_accuracy = 5e-6, place_accuracy = 0.01;
  int threads = 0;
  OptionSet::List outages = {};

  void declare(OptionSet& set);
};

/// An event camera that sees a brightness: a recording that is simulated while it is read. Within an interval of the
/// brightness a pixel's log intensity is a straight line; where the pixel emits events and the line is wrong by more
/// than time_accuracy, and by more than the time in which the image moves by place_accuracy, the interval is halved for
/// this pixel, down to Brightness::kParts parts. Events are ordered by (t, y, x). Equal brightness, options and seed
/// give equal bytes, whatever the number of threads.
class EventSimulator : public EventReader {
 public:
  /// From 0 to `duration` [s]. Throws InputError for outages that are no time spans.
  EventSimulator(std::unique_ptr<Brightness> brightness, const SimulatorOptions& options, double duration,
                 std::uint64_t seed);

  const StreamInfo& info() const override { return info_; }
  bool read(std::vector<Event>& events) override;
  /// Restarts unless t is still ahead: what was before t has to be simulated.
  void seek(std::int64_t t) override;
  const Faults& faults() const override { return faults_; }

 private:
  void restart();
  void step();
  void advance_row(int y);
  void advance_pixel(int x, int y, std::vector<Event>& events);
  void release(double until);
  bool is_read_out(const Event& event) const;

  std::unique_ptr<Brightness> brightness_;
  SimulatorOptions options_;
  std::vector<TimeSpan> outages_;
  double duration_;
  std::uint64_t seed_;
  StreamInfo info_;
  Faults faults_;
  std::vector<Pixel> pixels_;             ///< each in the state of its last update
  std::vector<Pixel::Quiet> quiet_;       ///< changes that need no update of the pixel
  std::vector<float> last_image_;         ///< log intensities at the interval's beginning
  double t_ = 0.0, interval_end_ = 0.0;   ///< [s]
  std::vector<std::vector<Event>> rows_;  ///< events of the interval
  std::vector<Event> waiting_;            ///< the next interval may have earlier events
  std::vector<Event> ready_;              ///< in order
};

}  // namespace evbench
