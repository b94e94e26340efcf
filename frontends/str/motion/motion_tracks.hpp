#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/events/event_front_end.hpp"
#include "frontends/str/batches.hpp"
#include "frontends/str/motion/options.hpp"

namespace evbench::str {

/// Registers batches of events to one motion of the whole image, and publishes it as tracks of virtual points: a grid
/// of rays that each batch's motion carries on. So any back-end can use a registered motion through the interface for
/// tracks. All observations at one time share one error, which their sigmas do not express.
///
/// Each batch begins where the previous one ends. A batch without a single motion is divided into halves, repeatedly.
/// Where the image motion reverses, spans remain in which it is too small to be registered: there it is interpolated
/// linearly between the motion before and after. Throws InputError for a source without events.
class MotionTracks : public EventFrontEnd {
 public:
  using Options = MotionTracksOptions;

  MotionTracks(const Options& options, const FrontEndContext& context);

 private:
  std::vector<std::string> counts() const override;
  struct Point {
    TrackId id;
    Vector3 ray;  ///< (x, y, 1)
  };

  struct Span {
    double from, to;  ///< [s]
    double middle() const { return 0.5 * (from + to); }
  };
  /// The motion of the image in a span of time.
  struct Motion {
    Span span;
    Matrix3 A;  ///< [1/s] (motion_model.hpp)
  };

  void take(std::span<const Event> events) override { batches_.add(events); }
  void on_tick() override;
  double complete() const override { return complete_; }
  void process(const Batch& batch);
  void move(const Motion& motion);
  void carry_on(const Motion& motion);
  void interrupt(double t);
  void replenish();
  void observe(const Point& point, double t);

  Options options_;
  Batches batches_;
  Registrar registrar_;
  std::vector<Point> points_;
  std::optional<Motion> last_;  ///< the newest known motion
  std::vector<Span> unknown_;   ///< spans of unknown motion since then
  double complete_;             ///< [s] all observations up to here have been made
  TrackId next_id_ = 0;
  std::size_t registered_ = 0, still_ = 0, divided_ = 0, unregistered_ = 0, interrupted_ = 0;
};

}  // namespace evbench::str
