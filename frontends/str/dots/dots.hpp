#pragma once

#include <optional>
#include <set>
#include <string>
#include <vector>

#include "core/events/event_front_end.hpp"
#include "frontends/str/batches.hpp"
#include "frontends/str/dots/options.hpp"
#include "frontends/str/dots/plane_map.hpp"

namespace evbench::str {

/// Tracks round dots, as in the first experiment of Liu et al., ICRA 2022. Batches of events are registered as point
/// clouds, and dots are detected as clusters of events in the image that the registration compensates. From then on the
/// events of a dot's rim give its centre at their own times. Throws InputError for a source without events.
class Dots : public EventFrontEnd {
 public:
  using Options = DotsOptions;

  Dots(const Options& options, const FrontEndContext& context);

 private:
  std::vector<std::string> counts() const override;
  struct Track {
    TrackId id;
    Dot dot;
    double radius;      ///< [px] when it was found
    double reported;    ///< [s] time of its last observation
    double way = 0.0;   ///< [px] path length of the image since its last event
    double seen = 0.0;  ///< [s] time of its newest event at the last batch
    bool lost = false;
  };

  void take(std::span<const Event> events) override;
  void on_tick() override;
  double complete() const override { return clock_ - options_.delay; }
  void take(const Event& event);
  void observe(Track& track);
  void list_near();
  void process(const Batch& batch);
  void give_up(const Batch& batch, const Registration& registration);
  void find_new(const Batch& batch, const Registration& registration);
  std::optional<TrackId> known_at(const Vector2& pixel) const;
  bool leaves(const Dot& dot, double t) const;

  Options options_;
  Batches batches_;
  Registrar registrar_;
  PlaneMap map_;
  std::vector<Track> tracks_;
  std::set<TrackId> out_of_view_;
  std::optional<Matrix3> last_motion_;
  int columns_, rows_;
  std::vector<std::vector<std::uint32_t>> near_;  ///< by cells of the image: the tracks whose rim may be there
  std::int64_t listed_;                           ///< [µs] when near_ was updated
  std::vector<Event> free_;                       ///< the current batch's events that belong to no dot
  TrackId next_id_ = 0;
  std::size_t found_again_ = 0, left_ = 0, misfits_ = 0, starved_ = 0, late_ = 0;
  std::size_t registered_ = 0, unregistered_ = 0;
};

}  // namespace evbench::str
