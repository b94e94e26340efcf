#pragma once

#include <span>
#include <string>

namespace evbench {

/// The candidate that is one or two edits away from `name`; else the shortest one that has all of its parts,
/// "ate.trans_m.rmse" for "ate.rmse"; else the one with the smallest edit distance, or an empty string when none is near
/// enough to be meant. Of equal ones the first.
std::string nearest_name(const std::string& name, std::span<const std::string> candidates);

/// `; did you mean "x"?` for the nearest candidate, else `; known: a, b, c`, or, where they are too many to be read,
/// `; the most similar of 250: a, b, c`.
std::string suggestion(const std::string& name, std::span<const std::string> candidates);

}  // namespace evbench
