#pragma once

#include <chrono>

namespace evbench {

/// Sums up wall time.
class Stopwatch {
 public:
  /// Runs call() and returns what it returns.
  template <class Call>
  auto time(Call call) {
    const Lap lap(*this);
    return call();
  }
  double seconds() const { return std::chrono::duration<double>(sum_).count(); }

 private:
  using Clock = std::chrono::steady_clock;

  /// Adds its lifetime, also when call() throws.
  class Lap {
   public:
    explicit Lap(Stopwatch& watch) : watch_(watch) {}
    ~Lap() { watch_.sum_ += Clock::now() - start_; }
    Lap(const Lap&) = delete;
    Lap& operator=(const Lap&) = delete;

   private:
    Stopwatch& watch_;
    Clock::time_point start_ = Clock::now();
  };

  Clock::duration sum_{};
};

}  // namespace evbench
