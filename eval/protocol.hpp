#pragma once

#include <string>

#include "eval/scores.hpp"

namespace evbench {

/// Parts of a protocol to print in addition to alignment and association.
struct ProtocolParts {
  bool relative = true, segments = true, latency = true;
};

/// The protocol of scores, in one line: alignment, association and tolerance, delta and pairing of the relative errors.
/// `scores`: from to_json(Scores). Throws InputError, beginning with `place`, if a part is missing.
std::string protocol(const Json& scores, const std::string& place, const ProtocolParts& parts = {});

/// The scores with their protocol as text: the output of `evbench eval`.
std::string describe(const Scores& scores);

}  // namespace evbench
