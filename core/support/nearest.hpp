#pragma once

#include <span>
#include <string>

namespace evbench {

/// The candidate with the smallest edit distance to `name`, or an empty string when none is near enough to be meant.
std::string nearest_name(const std::string& name, std::span<const std::string> candidates);

/// `; did you mean "x"?` for the nearest candidate, else `; known: a, b, c`, or, where they are too many to be read,
/// `; the most similar of 250: a, b, c`.
std::string suggestion(const std::string& name, std::span<const std::string> candidates);

}  // namespace evbench
