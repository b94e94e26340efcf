#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/events/event_front_end.hpp"
#include "frontends/str/batches.hpp"
#include "frontends/str/motion/options.hpp"

namespace evbench::str {

/// The motion of the image as a whole, by registration of batches of events, told as tracks of points that nothing need
/// be seen at: a grid of rays that each batch's motion carries on. So any back-end gets a registered motion by the one
/// interface that there is; the observations at one time have one error in common, which no sigma tells. Each batch
/// begins where the one before ends, and one that has no one motion is divided into halves, again and again. Where the
/// image turns round, that leaves spans in which it moves too little to be registered: their motion is taken to change
/// evenly from that before to that after. Throws InputError for a source without events.
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
  /// Of the image, in a span of time.
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
  std::optional<Motion> last_;  ///< that is known
  std::vector<Span> unknown_;   ///< since then
  double complete_;             ///< [s] all observations up to here have been made
  TrackId next_id_ = 0;
  std::size_t registered_ = 0, still_ = 0, divided_ = 0, unregistered_ = 0, interrupted_ = 0;
};

}  // namespace evbench::str
