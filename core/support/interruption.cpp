#include "core/support/interruption.hpp"

#include <atomic>
#include <utility>

#include "core/support/error.hpp"

namespace evbench {
namespace {

std::atomic<bool> requested = false;
static_assert(std::atomic<bool>::is_always_lock_free);  // for a signal's handler

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
    action.sa_handler = [](int) { requested = true; };
    action.sa_flags = static_cast<int>(SA_RESETHAND);  // without SA_RESTART: waiting for a pipe ends, too
    ::sigaction(kSignals[i], &action, nullptr);
  }
}

Interruption::~Interruption() {
  for (std::size_t i = 0; i < std::size(kSignals); ++i) ::sigaction(kSignals[i], &before_[i], nullptr);
  requested = false;
}

bool Interruption::is_requested() { return requested; }

void check_interruption() {
  if (requested) throw InputError(current_message());
}

}  // namespace evbench
