#include "core/simulation/random.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

namespace evbench {
namespace {

std::uint64_t splitmix64(std::uint64_t& state) {
  std::uint64_t z = (state += 0x9e3779b97f4a7c15ULL);
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
  return z ^ (z >> 31);
}

}  // namespace

Random::Random(std::uint64_t seed, std::uint64_t stream) {
  // The stream is mixed before it meets the seed: neighbouring seeds and streams must not meet in one state.
  std::uint64_t state = splitmix64(stream) ^ seed;
  for (std::uint64_t& word : state_) word = splitmix64(state);
}

std::uint64_t Random::next() {
  const std::uint64_t result = std::rotl(state_[0] + state_[3], 23) + state_[0];
  const std::uint64_t shifted = state_[1] << 17;
  state_[2] ^= state_[0];
  state_[3] ^= state_[1];
  state_[1] ^= state_[2];
  state_[0] ^= state_[3];
  state_[2] ^= shifted;
  state_[3] = std::rotl(state_[3], 45);
  return result;
}

double Random::uniform() { return static_cast<double>(next() >> 11) * 0x1.0p-53; }

std::size_t Random::index(std::size_t count) {
  const auto drawn = static_cast<std::size_t>(uniform() * static_cast<double>(count));
  return std::min(drawn, count - 1);
}

Vector2 Random::uniform2(const Vector2& from, const Vector2& to) {
  const double y = uniform(from.y(), to.y());
  return {uniform(from.x(), to.x()), y};
}

Vector3 Random::uniform3(const Vector3& from, const Vector3& to) {
  const double z = uniform(from.z(), to.z());
  const double y = uniform(from.y(), to.y());
  return {uniform(from.x(), to.x()), y, z};
}

Vector2 Random::normal2() {
  const double y = normal();
  return {normal(), y};
}

Vector3 Random::normal3() {
  const double z = normal();
  const double y = normal();
  return {normal(), y, z};
}

double Random::normal() {
  if (has_spare_) {
    has_spare_ = false;
    return spare_;
  }
  while (true) {
    const double x = uniform(-1.0, 1.0), y = uniform(-1.0, 1.0);
    const double s = x * x + y * y;
    if (s >= 1.0 || s == 0.0) continue;
    const double scale = std::sqrt(-2.0 * std::log(s) / s);
    spare_ = y * scale;
    has_spare_ = true;
    return x * scale;
  }
}

}  // namespace evbench
