#include "bench/sweep/draw.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <iterator>
#include <numeric>
#include <utility>

#include "bench/sweep/axis.hpp"
#include "core/simulation/random.hpp"
#include "core/support/error.hpp"

namespace evbench {
namespace {

constexpr std::array kDistributions = {"uniform", "log_uniform", "whole"};

/// The name of the distribution that a value is; empty: it is another value.
std::string distribution_of(const Json& value) {
  if (!value.is_object() || value.size() != 1) return "";
  for (const char* name : kDistributions) {
    if (value.contains(name)) return name;
  }
  return "";
}

/// FNV-1a, of 64 bits: a stream of random numbers for each name.
std::uint64_t stream_of(const std::string& name) {
  std::uint64_t hash = 0xcbf29ce484222325U;
  for (const char c : name) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3U;
  return hash;
}

std::string draw_number(const Json& value, const std::string& distribution, Random random, const std::string& place) {
  const Json& range = value[distribution];
  const InputError unfit(fmt::format("{}: {}; expected {{\"{}\": [A, B]}} with A < B{}", place, dump_json(value),
                                     distribution, distribution == "log_uniform" ? ", above 0" : ", two numbers"));
  if (!range.is_array() || range.size() != 2 || !range[0].is_number() || !range[1].is_number()) throw unfit;
  const double from = range[0].get<double>(), to = range[1].get<double>();
  if (!(from < to)) throw unfit;
  if (distribution == "whole") {
    if (from != std::floor(from) || to != std::floor(to) || !(to - from < 1e9)) throw unfit;
    return fmt::format("{}", static_cast<std::int64_t>(from) +
                                 static_cast<std::int64_t>(random.index(static_cast<std::size_t>(to - from) + 1)));
  }
  if (distribution == "uniform") return fmt::format("{:.4g}", random.uniform(from, to));
  if (from <= 0.0) throw unfit;
  return fmt::format("{:.4g}", from * std::pow(to / from, random.uniform()));
}

/// Below `count`; of the seeds from one multiple of `count` to the next, each draws another one.
std::size_t draw_index(std::size_t count, std::uint64_t seed, std::uint64_t stream) {
  Random random(seed / count, stream);
  std::vector<std::size_t> order(count);
  std::iota(order.begin(), order.end(), std::size_t{0});
  for (std::size_t i = count - 1; i > 0; --i) std::swap(order[i], order[random.index(i + 1)]);
  return order[seed % count];
}

}  // namespace

Drawn draw(const Json& items, std::uint64_t seed, const std::string& place) {
  if (!items.is_object()) {
    throw InputError(
        fmt::format("{}: expected an object of {{KEY: DISTRIBUTION}} and {{NAME: {{TEXT: {{KEY: VALUE}}}}}}", place));
  }
  Drawn drawn;
  for (const auto& [name, item] : items.items()) {
    const std::string at = place + "." + name;
    if (const std::string distribution = distribution_of(item); !distribution.empty()) {
      drawn.overrides.push_back(name + "=" + draw_number(item, distribution, Random(seed, stream_of(name)), at));
      continue;
    }
    if (!item.is_object() || item.empty()) {
      throw InputError(
          fmt::format("{}: expected a distribution (uniform, log_uniform, whole), or named sets, each an "
                      "object {{KEY: VALUE}}",
                      at));
    }
    auto chosen = item.begin();
    std::advance(chosen, draw_index(item.size(), seed, stream_of(name)));
    Drawn::Property& property = drawn.properties.emplace_back(Drawn::Property{name, chosen.key(), {}});
    for (const auto& [text, set] : item.items()) {  // errors in all of them, whichever is chosen
      if (!set.is_object()) throw InputError(fmt::format("{}.{}: expected an object {{KEY: VALUE}}", at, text));
      for (const auto& [key, value] : set.items()) {
        const std::string of_number = distribution_of(value);
        const std::string drawn_text = of_number.empty()
                                           ? override_text(value)
                                           : draw_number(value, of_number, Random(seed, stream_of(name + "." + key)),
                                                         fmt::format("{}.{}.{}", at, text, key));
        if (text != chosen.key()) continue;
        drawn.overrides.push_back(key + "=" + drawn_text);
        property.keys.push_back(key);
      }
    }
  }
  return drawn;
}

}  // namespace evbench
