#include "core/support/interruption.hpp"

#include <atomic>
#include <cstdint>
#include <ctime>
#include <utility>

namespace evbench {
namespace {

std::atomic<int> requested = 0;              // the received signal
std::atomic<std::int64_t> requested_at = 0;  // [ns]
static_assert(std::atomic<int>::is_always_lock_free &&
              std::atomic<std::int64_t>::is_always_lock_free);  // for use in a signal handler

void on_signal(int signal) {
  constexpr std::int64_t kSame = 500'000'000;  // [ns]
  timespec time{};
  ::clock_gettime(CLOCK_MONOTONIC, &time);
  const std::int64_t now = std::int64_t{time.tv_sec} * 1'000'000'000 + time.tv_nsec;
  if (requested == 0) {
    requested_at = now;
    requested = signal;
  } else if (now - requested_at > kSame) {
    std::signal(signal, SIG_DFL);
    std::raise(signal);
  }
}

std::string& current_message() {
  static std::string message;
  return message;
}

}  // namespace

Interruption::Interruption(std::string message) {
  current_message() = std::move(message);
  for (std::size_t i = 0; i < std::size(kSignals); ++i) {
    ::sigaction(kSignals[i], nullptr, &before_[i]);
    if (before_[i].sa_handler == SIG_IGN) continue;
    struct sigaction action {};
    action.sa_handler = on_signal;
    action.sa_flags = 0;  // without SA_RESTART, so that waiting for a pipe ends
    ::sigaction(kSignals[i], &action, nullptr);
  }
}

Interruption::~Interruption() {
  for (std::size_t i = 0; i < std::size(kSignals); ++i) ::sigaction(kSignals[i], &before_[i], nullptr);
  requested = 0;
}

bool Interruption::is_requested() { return requested != 0; }

void check_interruption() {
  if (const int signal = requested; signal != 0) throw Interrupted(current_message(), signal);
}

}  // namespace evbench
