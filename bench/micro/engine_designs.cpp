// Two orders of elimination for the engine, as kernels: floating-point operations and measured
// time for one control state, without linearisation. See docs/algorithms/smoother.md.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <vector>

#include "core/smoother/engine/dense_kernels.hpp"

namespace {

using namespace evbench::smoother;

constexpr int kLargest = 4096;  ///< rows that are measured, not only counted

/// Median time of C −= A Aᵀ, n × n, rank p [s]; 0 beyond the largest.
double update_seconds(int n, int p) {
  if (n > kLargest) return 0.0;
  const int stride = (n / kPadding | 1) * kPadding;
  Buffer C(static_cast<std::size_t>(stride) * static_cast<std::size_t>(n), 0.1);
  Buffer A(static_cast<std::size_t>(n) * static_cast<std::size_t>(p), 1e-6);
  std::vector<double> seconds;
  for (int i = 0; i < 9; ++i) {
    const auto start = std::chrono::steady_clock::now();
    subtract_outer_product(C.data(), stride, A.data(), n, n, p);
    seconds.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  }
  std::ranges::nth_element(seconds, seconds.begin() + 4);
  return seconds[4];
}

double flops(double n, double p) { return n * n * p; }  // multiplications and additions, lower triangle

void compare(int live, double life, double longest_life, double rate) {
  const double ended = live / (life * rate);  // landmarks a state
  const int root = padded(24 + 3 * live);
  const int pivots = 12 + static_cast<int>(std::lround(3.0 * ended));
  const double chain_flops = flops(root, pivots);
  const double chain = update_seconds(root, pivots);
  const int seen = padded(static_cast<int>(12.0 * (life * rate + 1.0)));
  const int band = padded(static_cast<int>(12.0 * (longest_life * rate + 1.0)));
  const double schur_flops = ended * flops(seen, 3) + flops(band, 12);
  const double schur = ended * update_seconds(seen, 3) + update_seconds(band, 12);
  const auto time = [](double seconds, bool measured) { return measured ? fmt::format("{:.0f}", 1e6 * seconds) : "-"; };
  fmt::print("| {} | {:g} to {:g} | {:g} | {:.2f} | {} | {:.2f} | {} |\n", live, 2.0 * life - longest_life,
             longest_life, rate, 1e-6 * chain_flops, time(chain, true), 1e-6 * schur_flops,
             time(schur, seen <= kLargest && band <= kLargest));
}

}  // namespace

int main() {
  fmt::print("| live landmarks | life [s] | states/s | chain: MFlop | µs | Schur: MFlop | µs |\n");
  fmt::print("| --- | --- | --- | --- | --- | --- | --- |\n");
  for (const double rate : {20.0, 100.0}) {
    for (const int live : {60, 100, 200}) {
      compare(live, 1.25, 2.0, rate);
      compare(live, 10.0, 10.0, rate);
    }
    compare(200, 0.1, 0.15, rate);
  }
}
