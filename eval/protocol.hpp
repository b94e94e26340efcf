#pragma once

#include <string>

#include "eval/scores.hpp"

namespace evbench {

/// What is told of a protocol beside alignment and association.
struct ProtocolParts {
  bool relative = true, segments = true, latency = true;
};

/// How a set of scores came about, in one line: alignment, association and tolerance, delta and pairing of the relative
/// errors. `scores` is what to_json(Scores) gives; throws InputError, beginning with `place`, when a part is missing.
std::string protocol(const Json& scores, const std::string& place, const ProtocolParts& parts = {});

/// The scores with their protocol as text for people: what `evbench eval` prints.
std::string describe(const Scores& scores);

}  // namespace evbench
