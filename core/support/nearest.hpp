#pragma once

#include <span>
#include <string>

namespace evbench {

/// The candidate within two edits of `name`; else the shortest one that contains all of its parts ("ate.trans_m.rmse"
/// for "ate.rmse"); else the one with the smallest edit distance. Empty if none is similar enough. Of equal ones the
/// first.
std::string nearest_name(const std::string& name, std::span<const std::string> candidates);

/// `; did you mean "x"?` for the nearest candidate; else `; known: a, b, c`, or for many candidates
/// `; the most similar of 250: a, b, c`.
std::string suggestion(const std::string& name, std::span<const std::string> candidates);

}  // namespace evbench
