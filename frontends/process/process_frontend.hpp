#pragma once

#include <deque>
#include <memory>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "core/plugin/frontend.hpp"
#include "core/process/dialogue.hpp"

namespace evbench::process {

/// A front-end in any language: a command that receives events on its standard input, in chunks, and answers with
/// observations on its standard output (docs/reference/process_protocol.md). Throws InputError for a source without
/// events; ProcessError, from its construction or any call, if the command can't be started, ends, is silent for too
/// long or answers wrongly.
class ProcessFrontEnd : public FrontEnd {
 public:
  struct Options : ProcessOptions {
    int chunk = 5000;  ///< most events in a message

    void declare(OptionSet& set);
  };

  ProcessFrontEnd(const Options& options, const FrontEndContext& context);

  bool advance(const Horizon& horizon, TrackBatch& batch) override;
  FeedbackNeeds needs() const override { return needs_; }
  void receive(const Feedback& feedback) override;
  std::vector<std::string> remarks() const override { return remarks_; }

 private:
  void open(const Options& options, const FrontEndContext& context);
  void send_chunk(double until);
  bool read_events();
  void take_answer(const Json& answer, double until);
  void check_observation(const TrackObservation& z, double until, std::size_t index);
  void check_end(const TrackEnd& end, double until, std::size_t index);
  void finish();

  Dialogue dialogue_;
  std::size_t chunk_;
  TimeRange range_;
  FeedbackNeeds needs_;
  Line feedback_;  ///< to be sent next: objects, separated by commas

  std::unique_ptr<EventStream> stream_;  ///< nullptr at its end
  std::vector<Event> events_;            ///< read; from sent_ on not yet sent
  std::size_t sent_ = 0;
  double seen_;            ///< [s] the process has answered up to here
  bool seen_any_ = false;  ///< until then, observations at the time seen_ itself are new, too
  bool finished_ = false;

  std::deque<TrackObservation> observations_;   ///< received, not yet handed over
  std::deque<TrackEnd> ends_;                   ///< likewise
  std::unordered_map<TrackId, double> newest_;  ///< [s] last observation of each live track
  std::unordered_set<TrackId> dead_;
  std::vector<std::string> remarks_;
};

}  // namespace evbench::process
