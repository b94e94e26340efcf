#pragma once

#include <string>
#include <vector>

#include "core/support/json.hpp"
#include "eval/scores.hpp"

namespace evbench {

/// A protocol by which results are published.
struct NamedProtocol {
  const char* name;
  const char* source;      ///< tool or papers that use it
  const char* definition;  ///< in a sentence, with what the options do not say
  const char* metrics;     ///< keys of the numbers that are published by it
  ScoreOptions options;
};
const std::vector<NamedProtocol>& named_protocols();

/// Their names, after "none".
std::vector<std::string> protocol_choices();

/// Takes all options of protocols out of `evaluation` (an object), so that another one can be named in it.
void forget_protocol(Json& evaluation);

/// Fills in the options of the protocol that `evaluation` (an object) names, but for those that it gives itself.
/// Options of the data (time_offset, time_range, min_pairs, latency) belong to no protocol. Does nothing without a
/// protocol, or for an unknown name, which read_options() refuses.
void fill_in_protocol(Json& evaluation);

/// The options by a protocol, with the options of the data from `data`. Throws InputError, with the nearest name, for
/// an unknown one.
ScoreOptions options_by_protocol(const std::string& name, const ScoreOptions& data = {});

/// {"name": NAME, "custom": [names of the options that differ from the protocol]}; null without one.
Json protocol_json(const ScoreOptions& options);

/// All protocols with source, definition and metrics: the output of `evbench list protocols`.
std::string describe_protocols();

}  // namespace evbench
