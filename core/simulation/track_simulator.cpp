#include "core/simulation/track_simulator.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <queue>
#include <tuple>

#include "core/simulation/time_spans.hpp"
#include "core/simulation/track_wander.hpp"
#include "core/support/error.hpp"

namespace evbench {
namespace {

constexpr double kRebirth = 0.02;  // [s] within which a new track takes an ended one's place
constexpr double kRetry = 0.05;    // [s] until a birth is tried again when nothing is in view

/// An offset over the image, added to the motion of its point (drifting track) or in place of it (outlier).
struct ImageMotion {
  Vector2 velocity = Vector2::Zero();   // [px/s]
  Vector2 amplitude = Vector2::Zero();  // [px]
  double frequency = 0.0, phase = 0.0;  // [Hz], [rad]

  Vector2 operator()(double dt) const {
    return velocity * dt + amplitude * (std::sin(2.0 * M_PI * frequency * dt + phase) - std::sin(phase));
  }
};

Vector2 random_direction(Random& random) {
  const double angle = random.uniform(0.0, 2.0 * M_PI);
  return {std::cos(angle), std::sin(angle)};
}

class TrackSimulator {
 public:
  TrackSimulator(const TrackOptions& options, const Camera& camera, const Motion& motion, Scene& scene, double duration,
                 std::uint64_t seed, const std::string& place)
      : options_(options),
        camera_(camera),
        motion_(motion),
        scene_(scene),
        duration_(duration),
        random_(seed),
        blackouts_(parse_time_spans(options.blackouts, place + ".blackouts")),
        sigma_(std::max(0.1, std::hypot(options.noise, options.quantisation / std::sqrt(12.0)))) {}

  SimulatedTracks run() {
    using Birth = std::pair<double, int>;  // time, slot
    std::priority_queue<Birth, std::vector<Birth>, std::greater<>> births;
    for (int slot = 0; slot < options_.alive; ++slot) births.push({random_.uniform(0.0, kRebirth), slot});
    while (!births.empty()) {
      auto [t, slot] = births.top();
      births.pop();
      const TimeSpan* const dark = blackout_at(t);
      if (dark != nullptr) {
        births.push({dark->to + random_.uniform(0.0, kRebirth), slot});
      } else if (t < duration_) {
        births.push({track(t) + random_.uniform(0.0, kRebirth), slot});
      }
    }
    std::ranges::sort(result_.observations, {}, [](const TrackObservation& o) { return std::tuple(o.t, o.track); });
    return std::move(result_);
  }

 private:
  const TrackOptions& options_;
  const Camera& camera_;
  const Motion& motion_;
  Scene& scene_;
  double duration_;
  Random random_;
  std::vector<TimeSpan> blackouts_;
  double sigma_;
  SimulatedTracks result_;

  /// The blackout that t lies in, if any.
  const TimeSpan* blackout_at(double t) const {
    const auto found =
        std::ranges::find_if(blackouts_, [t](const TimeSpan& span) { return t >= span.from && t <= span.to; });
    return found == blackouts_.end() ? nullptr : &*found;
  }

  TrackKind draw_kind() {
    const double u = random_.uniform();
    if (u < options_.outlier_share) return TrackKind::outlier;
    return u < options_.outlier_share + options_.drift_share ? TrackKind::drift : TrackKind::inlier;
  }

  ImageMotion draw_image_motion(TrackKind kind) {
    ImageMotion motion;
    if (kind == TrackKind::outlier) {
      const Vector2 direction = random_direction(random_);
      motion.velocity = options_.outlier_speed * random_.uniform(0.5, 1.5) * direction;
      motion.frequency = random_.uniform(0.3, 1.0);
      motion.phase = random_.uniform(0.0, 2.0 * M_PI);
      motion.amplitude = 0.2 * options_.outlier_speed * random_direction(random_);
    } else if (kind == TrackKind::drift) {
      motion.velocity = options_.drift_speed * random_direction(random_);
    }
    return motion;
  }

  /// Simulates one track from its birth on; the time at which it ended, or at which a birth may be tried again.
  double track(double birth) {
    const std::optional<Scene::Pick> pick = scene_.pick(birth, motion_(birth), options_.border, random_);
    if (!pick) return birth + kRetry;
    const TrackKind kind = draw_kind();
    const ImageMotion image_motion = draw_image_motion(kind);
    const double end = std::min(duration_, birth + random_.uniform(options_.lifetime[0], options_.lifetime[1]));
    const double gap = 1.0 / random_.uniform(options_.rate[0], options_.rate[1]);
    const std::optional<Vector2> start = scene_.pixel(motion_(birth), pick->position, options_.border);

    const std::size_t before = result_.observations.size();
    double dropout = next_dropout(birth);
    double t = birth + random_.uniform(0.0, gap);
    for (; t <= end; t += gap * random_.uniform(0.4, 1.6)) {
      if (t >= dropout) {
        t += random_.uniform(options_.dropout_length[0], options_.dropout_length[1]);
        dropout = next_dropout(t);
        if (t > end) break;
      }
      const double stamp = std::min(std::round(t * 1e6) * 1e-6, duration_);
      if (blackout_at(stamp) != nullptr) break;
      std::optional<Vector2> pixel =
          kind == TrackKind::outlier ? start : scene_.pixel(motion_(stamp), pick->position, options_.border);
      if (pixel) *pixel += image_motion(stamp - birth);
      if (!pixel || !camera_.contains(*pixel, options_.border)) break;
      observe(stamp, *pixel);
    }
    if (result_.observations.size() > before) result_.tracks.push_back({kind, pick->position});
    const double ended = std::min(t, end);
    scene_.occupy(*pick, ended);
    return ended;
  }

  double next_dropout(double t) {
    if (!(options_.dropout_rate > 0.0)) return std::numeric_limits<double>::infinity();
    return t - std::log(1.0 - random_.uniform()) / options_.dropout_rate;  // exponential: a Poisson process
  }

  void observe(double t, const Vector2& ideal) {
    const Vector2 pixel = ideal + options_.noise * random_.normal2();
    result_.observations.push_back({static_cast<TrackId>(result_.tracks.size()), t, pixel, sigma_});
  }
};

void check_interval(const std::vector<double>& interval, const std::string& place) {
  if (interval.size() != 2 || !(interval[0] <= interval[1])) {
    throw InputError(fmt::format("{}: expected [smallest, largest] with smallest <= largest", place));
  }
}

}  // namespace

void TrackOptions::declare(OptionSet& set) {
  set.add("alive", alive, "number of tracks alive at any time, if the camera sees enough points").range(1, 1e5);
  set.add("lifetime", lifetime, "smallest and largest lifetime of a track [s]").above(0.0).size(2);
  set.add("rate", rate, "smallest and largest mean update rate of a track [Hz]").range(0.1, 1e5).size(2);
  set.add("noise", noise, "standard deviation of the pixel noise, each axis [px]").range(0.0);
  set.add("wander", wander,
          "standard deviation of an additional slow error: each track drifts about its point, each axis [px]")
      .range(0.0);
  set.add("wander_time", wander_time, "correlation time of that error, exp(-dt/wander_time) [s]").above(0.0);
  set.add("quantisation", quantisation, "pixels are rounded to multiples of this [px]; 0: not rounded").range(0.0);
  set.add("outlier_share", outlier_share, "share of the tracks that move independently of the scene").range(0.0, 1.0);
  set.add("outlier_speed", outlier_speed, "mean speed of those [px/s]").range(0.0);
  set.add("drift_share", drift_share, "share of the tracks that drift off their point").range(0.0, 1.0);
  set.add("drift_speed", drift_speed, "speed of those relative to the point [px/s]").range(0.0);
  set.add("dropout_rate", dropout_rate, "gaps in a track per second [Hz]").range(0.0, 1e4);
  set.add("dropout_length", dropout_length, "smallest and largest length of such a gap [s]").range(0.0).size(2);
  set.add("border", border, "a track ends this far from the image's border [px]").range(0.0);
  set.add("blackouts", blackouts, "spans without observations, which end all tracks [from, to, from, to, ...] [s]");
}

void TrackOptions::check(const Camera& camera, const std::string& place) const {
  check_interval(lifetime, place + ".lifetime");
  check_interval(rate, place + ".rate");
  check_interval(dropout_length, place + ".dropout_length");
  if (outlier_share + drift_share > 1.0) {
    throw InputError(
        fmt::format("{}: outlier_share + drift_share is {}; expected at most 1", place, outlier_share + drift_share));
  }
  check_border(border, camera, place + ".border");
}

SimulatedTracks simulate_tracks(const TrackOptions& options, const Camera& camera, const Motion& motion, Scene& scene,
                                double duration, std::uint64_t seed, const std::string& place) {
  options.check(camera, place);
  SimulatedTracks tracks = TrackSimulator(options, camera, motion, scene, duration, seed, place).run();
  if (options.wander > 0.0) add_wander(tracks.observations, options.wander, options.wander_time, Random(seed, 2));
  for (TrackObservation& z : tracks.observations) {
    if (options.quantisation > 0.0) z.pixel = options.quantisation * (z.pixel / options.quantisation).array().round();
  }
  if (tracks.observations.empty()) {
    throw InputError(
        fmt::format("{}: no observation in {} s; the camera sees no point of the scene, or blackouts cover "
                    "all the time",
                    place, duration));
  }
  return tracks;
}

}  // namespace evbench
