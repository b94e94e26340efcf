#pragma once

#include <span>

#include "core/plugin/registry.hpp"

namespace evbench {

/// Hands on the tracks that the source itself knows: association without error. Throws InputError for a source that
/// knows none, such as a recording.
class Oracle : public FrontEnd {
 public:
  struct Options {
    void declare(OptionSet&) {}
  };

  Oracle(const Options& options, const FrontEndContext& context);

  bool advance(double until, std::vector<TrackObservation>& observations) override;

 private:
  std::span<const TrackObservation> left_;
};

}  // namespace evbench
