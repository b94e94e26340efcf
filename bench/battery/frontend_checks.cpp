#include <algorithm>
#include <cmath>
#include <map>

#include "bench/battery/battery.hpp"
#include "bench/battery/track_source.hpp"

namespace evbench::battery {
namespace {

/// A front-end made as from a config, on one source.
class CandidateFrontEnd {
 public:
  CandidateFrontEnd(const Plugins& plugins, const std::string& name, const Json& options, const Source& source,
                    const std::string& folder)
      : entry_(plugins.of<FrontEnd>().find(name, "battery")),
        options_(entry_.resolve(options, name, folder)),
        source_(source),
        folder_(folder),
        name_(name) {}

  std::unique_ptr<FrontEnd> make() const { return entry_.make(options_, {source_, 1, folder_, name_}); }
  const Source& source() const { return source_; }

  /// All its output, in exchanges of `interval` [s] and at most `most` observations. Checks each batch.
  TrackBatch all(double interval, std::size_t most = 0) const;

 private:
  const Registry<FrontEnd>::Entry& entry_;
  Json options_;
  const Source& source_;
  std::string folder_, name_;
};

/// `until` and `seen` of the last batch (TrackBatch).
struct Progress {
  double until, seen;
  bool first = true;

  void update(const TrackBatch& batch) { *this = {batch.until, batch.known_at(), false}; }
};

void check_batch(const TrackBatch& batch, const Progress& progress, const FrontEnd::Horizon& horizon) {
  const auto& [before, clock, first] = progress;
  const double seen = batch.known_at();
  const bool goes_on = batch.until > before || seen > clock || first;
  require(batch.until >= before && batch.until <= seen && seen >= clock && seen <= horizon.t && goes_on,
          "requested up to {} s, from {} s on, its batch ends at {} s and is known at {} s", horizon.t, before,
          batch.until, seen);
  double t = before;
  for (const TrackObservation& z : batch.observations) {
    require(z.t >= t, "its observation at {} s comes after one at {} s", z.t, t);
    require(z.t > before || first, "its observation at {} s belongs to the batch before, up to {} s", z.t, before);
    require(z.t <= batch.until, "its observation at {} s is later than its batch, up to {} s", z.t, batch.until);
    require(z.pixel.allFinite() && z.noise.is_valid(),
            "its observation of track {} at {} s is not finite, or its noise is not positive definite", z.track, z.t);
    t = z.t;
  }
  for (const TrackEnd& end : batch.ended) {
    require(end.t <= batch.until, "the end of track {} at {} s is later than its batch", end.track, end.t);
  }
}

TrackBatch CandidateFrontEnd::all(double interval, std::size_t most) const {
  const auto frontend = make();
  const TimeRange range = source_.time_range();
  TrackBatch everything, batch;
  Progress progress{range.from, range.from};
  bool more = true;
  for (std::int64_t k = 1; more && progress.until < range.to;) {
    const double t = std::min(range.to, range.from + static_cast<double>(k) * interval);
    more = frontend->advance({t, most}, batch);
    check_batch(batch, progress, {t, most});
    everything.observations.insert(everything.observations.end(), batch.observations.begin(), batch.observations.end());
    everything.ended.insert(everything.ended.end(), batch.ended.begin(), batch.ended.end());
    progress.update(batch);
    if (progress.seen >= t) ++k;
  }
  everything.until = progress.until;
  return everything;
}

bool same(const TrackBatch& a, const TrackBatch& b) {
  const auto equal = [](const TrackObservation& x, const TrackObservation& y) {
    return x.track == y.track && x.t == y.t && x.pixel == y.pixel && x.noise == y.noise;
  };
  const auto ends = [](const TrackEnd& x, const TrackEnd& y) { return x.track == y.track && x.t == y.t; };
  return std::ranges::equal(a.observations, b.observations, equal) && std::ranges::equal(a.ended, b.ended, ends);
}

void has_observations_in_order(const CandidateFrontEnd& candidate) {
  const TrackBatch all = candidate.all(0.01);
  require(!all.observations.empty(), "it has no observation in the whole source");
}

void ends_each_track_once(const CandidateFrontEnd& candidate) {
  const TrackBatch all = candidate.all(0.01);
  std::map<TrackId, double> last, ended;
  for (const TrackObservation& z : all.observations) last[z.track] = z.t;
  for (const TrackEnd& end : all.ended) {
    require(ended.emplace(end.track, end.t).second, "track {} ends twice", end.track);
    const auto seen = last.find(end.track);
    require(seen == last.end() || seen->second <= end.t, "track {} ended at {} s and is observed at {} s", end.track,
            end.t, seen == last.end() ? 0.0 : seen->second);
  }
}

void repeats_itself(const CandidateFrontEnd& candidate) {
  require(same(candidate.all(0.01), candidate.all(0.01)), "made twice, its tracks differ");
}

/// Without feedback: a front-end that uses it may give other tracks if it arrives at other times.
void does_not_depend_on_the_exchanges(const CandidateFrontEnd& candidate) {
  const TrackBatch usual = candidate.all(0.01);
  require(same(usual, candidate.all(0.1)), "with exchanges of 0.1 s instead of 0.01 s its tracks differ");
  require(same(usual, candidate.all(0.01, 3)), "with three observations per exchange its tracks differ");
}

void accepts_any_feedback(const CandidateFrontEnd& candidate) {
  const auto frontend = candidate.make();
  const TimeRange range = candidate.source().time_range();
  TrackBatch batch;
  Progress progress{range.from, range.from};
  for (int k = 1; k <= 100 && progress.until < range.to; ++k) {
    const double t = std::min(range.to, range.from + 0.01 * k);
    const bool more = frontend->advance({t}, batch);
    check_batch(batch, progress, {t});
    progress.update(batch);
    Feedback feedback;
    feedback.t = batch.until;
    feedback.state = static_cast<TrackingState>(k % 5);
    if (k % 3 == 0)
      feedback.newest = ControlState{batch.until, {Eigen::Quaterniond::Identity(), {1e9, 0, 0}}, Vector6::Ones()};
    if (!batch.observations.empty()) {
      feedback.outliers = {batch.observations.front().track, -17};
      feedback.expected.push_back(
          {batch.observations.back().track, {0, 0, 1e-9}, {-1e9, 1e9}, 1e12 * Matrix2::Identity()});
      feedback.expected.push_back({4711, {0, 0, 1}, {10, 10}, Matrix2::Zero()});
    }
    frontend->receive(feedback);
    if (!more) break;
  }
}

}  // namespace

std::vector<Check> frontend_checks(const Plugins& plugins, const std::string& name, const Json& options,
                                   const Source& source, const std::string& folder) {
  const CandidateFrontEnd candidate(plugins, name, options, source, folder);
  const auto check = [&](const char* text, void (*run)(const CandidateFrontEnd&)) {
    return Check{text, [=] { run(candidate); }};
  };
  return {
      check("gives observations in time order, within the requested time", has_observations_in_order),
      check("ends a track once, and does not observe it afterwards", ends_each_track_once),
      check("gives the same tracks when it is made twice", repeats_itself),
      check("gives the same tracks whatever the exchanges are", does_not_depend_on_the_exchanges),
      check("accepts any feedback", accepts_any_feedback),
  };
}

const Source& usual_source() {
  static const TrackSource source({});
  return source;
}

}  // namespace evbench::battery
