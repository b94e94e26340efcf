#include "core/support/interruption.hpp"

#include <atomic>
#include <utility>

namespace evbench {
namespace {

std::atomic<int> requested = 0;                        // the signal that came
static_assert(std::atomic<int>::is_always_lock_free);  // for a signal's handler

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
    action.sa_handler = [](int signal) { requested = signal; };
    action.sa_flags = static_cast<int>(SA_RESETHAND);  // without SA_RESTART: waiting for a pipe ends, too
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
