#include "frontends/process/process_frontend.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "core/plugin/registration.hpp"
#include "core/support/error.hpp"

namespace evbench::process {
namespace {

const Registration<FrontEnd, ProcessFrontEnd> registration(
    "process", "a command in any language (docs/reference/process_protocol.md)");

double seconds(const Event& event) { return static_cast<double>(event.t) / 1e6; }  // as write_events()

Json greeting(const ProcessOptions& options, const FrontEndContext& context) {
  const Camera& camera = context.source.camera();
  const TimeRange range = context.source.time_range();
  const PinholeCamera& pinhole = camera.pinhole;
  std::vector<double> coefficients;
  if (camera.distortion != DistortionModel::none) {
    const Eigen::Index count = camera.distortion == DistortionModel::equidistant ? 4 : 5;
    coefficients.assign(camera.coefficients.data(), camera.coefficients.data() + count);
  }
  const Json lens = {{"model", to_string(camera.distortion)}, {"coefficients", coefficients}};
  return {{"kind", "frontend"},
          {"seed", context.seed},
          {"range", {range.from, range.to}},
          {"camera",
           {{"width", camera.width},
            {"height", camera.height},
            {"fx", pinhole.fx},
            {"fy", pinhole.fy},
            {"cx", pinhole.cx},
            {"cy", pinhole.cy},
            {"distortion", lens}}},
          {"options", options.options}};
}

FeedbackNeeds read_needs(const Json& value) {
  FeedbackNeeds needs;
  for (std::size_t i = 0; i < list(value, {"needs"}).size(); ++i) {
    const std::string name = text(value[i], {"needs", i});
    if (name != "feedback" && name != "covariance" && name != "expected") {
      throw MessageError(fmt::format("needs[{}]: expected \"feedback\", \"covariance\" or \"expected\", found \"{}\"",
                                     i, printable(name, 60)));
    }
    needs.any = true;
    needs.covariance = needs.covariance || name == "covariance";
    needs.expected = needs.expected || name == "expected";
  }
  return needs;
}

}  // namespace

void ProcessFrontEnd::Options::declare(OptionSet& set) {
  ProcessOptions::declare(set);
  set.add("chunk", chunk, "most events in a message").range(1, 1000000);
}

ProcessFrontEnd::ProcessFrontEnd(const Options& options, const FrontEndContext& context)
    : dialogue_(options, context.place, context.folder),
      chunk_(static_cast<std::size_t>(options.chunk)),
      range_(context.source.time_range()),
      stream_(context.source.events()),
      seen_(range_.from) {
  if (!stream_) {
    throw InputError(
        fmt::format("{}: process needs a source with events; expected another front-end (oracle, recorded) "
                    "for this one, which has tracks alone",
                    context.place));
  }
  open(options, context);
}

void ProcessFrontEnd::open(const Options& options, const FrontEndContext& context) {
  const Json answer = dialogue_.open(greeting(options, context), {"needs"});
  if (const Json* const needs = find(answer, "needs")) needs_ = read_needs(*needs);
  remarks_.push_back("front-end process: " + dialogue_.name());
}

bool ProcessFrontEnd::advance(const Horizon& horizon, TrackBatch& batch) {
  const auto reached = [&] { return horizon.observations > 0 && observations_.size() >= horizon.observations; };
  while (!finished_ && !reached() && (seen_ < horizon.t || !seen_any_)) send_chunk(horizon.t);
  if (!finished_ && seen_ >= range_.to) finish();

  batch.until = reached() ? std::min(horizon.t, observations_[horizon.observations - 1].t) : horizon.t;
  const auto observed = std::ranges::upper_bound(observations_, batch.until, {}, &TrackObservation::t);
  batch.observations.assign(observations_.begin(), observed);
  observations_.erase(observations_.begin(), observed);
  const auto ended = std::ranges::upper_bound(ends_, batch.until, {}, &TrackEnd::t);
  batch.ended.assign(ends_.begin(), ended);
  ends_.erase(ends_.begin(), ended);
  return !finished_ || !observations_.empty() || !ends_.empty();
}

/// False if there are no more.
bool ProcessFrontEnd::read_events() {
  if (!stream_) return false;
  events_.erase(events_.begin(), events_.begin() + static_cast<std::ptrdiff_t>(sent_));
  sent_ = 0;
  std::vector<Event> more;
  if (!stream_->read(more)) {
    stream_.reset();
    return false;
  }
  events_.insert(events_.end(), more.begin(), more.end());
  return true;
}

/// Sends the next events. Events of the same time are sent together, so that `until` is complete.
void ProcessFrontEnd::send_chunk(double until) {
  std::size_t end = sent_;
  while (true) {
    if (end == events_.size()) {
      const std::size_t count = end - sent_;
      if (!read_events()) break;
      end = sent_ + count;
      continue;
    }
    if (seconds(events_[end]) > until) break;
    if (end - sent_ >= chunk_ && events_[end].t != events_[end - 1].t) {
      until = seconds(events_[end - 1]);
      break;
    }
    ++end;
  }
  Line line;
  fmt::format_to(std::back_inserter(line), "{{\"until\":{},\"events\":", until);
  write_events(line, std::span(events_).subspan(sent_, end - sent_));
  if (needs_.any) {
    fmt::format_to(std::back_inserter(line), ",\"feedback\":[{}]",
                   std::string_view(feedback_.data(), feedback_.size()));
    feedback_.clear();
  }
  line.push_back('}');
  dialogue_.ask(line, fmt::format("the events until {} s", until),
                [&](const Json& answer) { take_answer(answer, until); });
  sent_ = end;
  seen_ = until;
  seen_any_ = true;
}

void ProcessFrontEnd::take_answer(const Json& answer, double until) {
  check_keys(answer, {"observations", "covariances", "ended"});
  const std::vector<TrackObservation> observed =
      observations(require(answer, "observations"), find(answer, "covariances"));
  for (std::size_t i = 0; i < observed.size(); ++i) check_observation(observed[i], until, i);
  observations_.insert(observations_.end(), observed.begin(), observed.end());
  const Json* const found = find(answer, "ended");
  if (found == nullptr) return;
  const std::vector<TrackEnd> ended = track_ends(*found);
  for (std::size_t i = 0; i < ended.size(); ++i) check_end(ended[i], until, i);
  ends_.insert(ends_.end(), ended.begin(), ended.end());
}

void ProcessFrontEnd::check_observation(const TrackObservation& z, double until, std::size_t index) {
  const auto refuse = [&](const std::string& why) {
    throw MessageError(fmt::format("observations[{}]: track {} at {} s: {}", index, z.track, z.t, why));
  };
  const bool late = seen_any_ ? z.t <= seen_ : z.t < seen_;
  if (late || z.t > until) {
    refuse(fmt::format("expected a time {} {} s and up to {} s", seen_any_ ? "after" : "from", seen_, until));
  }
  if (dead_.contains(z.track)) refuse("has ended before; expected another number for a new track");
  const auto [newest, is_new] = newest_.try_emplace(z.track, z.t);
  if (!is_new && z.t <= newest->second) {
    refuse(fmt::format("expected a time after the track's last, {} s", newest->second));
  }
  newest->second = z.t;
}

void ProcessFrontEnd::check_end(const TrackEnd& end, double until, std::size_t index) {
  const auto refuse = [&](const std::string& why) {
    throw MessageError(fmt::format("ended[{}]: track {} at {} s: {}", index, end.track, end.t, why));
  };
  const bool late = seen_any_ ? end.t <= seen_ : end.t < seen_;
  if (late || end.t > until) {
    refuse(fmt::format("expected a time {} {} s and up to {} s", seen_any_ ? "after" : "from", seen_, until));
  }
  const auto newest = newest_.find(end.track);
  if (newest == newest_.end()) {
    refuse(dead_.contains(end.track) ? "has ended before" : "was never observed; expected a track that was");
  }
  if (end.t < newest->second) refuse(fmt::format("expected a time from its last observation on, {} s", newest->second));
  newest_.erase(newest);
  dead_.insert(end.track);
}

void ProcessFrontEnd::receive(const Feedback& feedback) {
  if (!needs_.any || finished_) return;
  if (feedback_.size() > 0) feedback_.push_back(',');
  write_feedback(feedback_, feedback);
}

void ProcessFrontEnd::finish() {
  finished_ = true;
  dialogue_.finish([this](const Json& answer) {
    check_keys(answer, {"remarks"});
    const Json* const given = find(answer, "remarks");
    for (std::size_t i = 0; given != nullptr && i < list(*given, {"remarks"}).size(); ++i) {
      remarks_.push_back(text((*given)[i], {"remarks", i}));
    }
  });
  if (const std::string errors = dialogue_.errors(); !errors.empty()) {
    remarks_.push_back("standard error of the front-end process:" + errors);
  }
}

}  // namespace evbench::process
