#pragma once

#include <csignal>
#include <string>

#include "core/support/error.hpp"

namespace evbench {

/// The program has been asked to end. Its exit code is then 128 + signal, as a shell has it: 130 after Ctrl-C.
class Interrupted : public InputError {
 public:
  Interrupted(const std::string& message, int signal) : InputError(message), signal_(signal) {}
  int signal() const { return signal_; }

 private:
  int signal_;
};

/// While one lives, a signal that asks the program to end (SIGINT by Ctrl-C, SIGTERM, SIGHUP) lets the next
/// check_interruption() throw, so that what was begun is removed as after an error. Another one, half a second later or
/// more, ends the program at once; those before are the same, as terminals, shells and `timeout` may each send it. A
/// signal that was ignored (nohup) stays so. There is one at a time.
class Interruption {
 public:
  /// `message`: of the error, e.g. "a.txt: interrupted; nothing was written".
  explicit Interruption(std::string message);
  ~Interruption();
  Interruption(const Interruption&) = delete;
  Interruption& operator=(const Interruption&) = delete;

  /// Has the program been asked to end?
  static bool is_requested();

 private:
  static constexpr int kSignals[] = {SIGINT, SIGTERM, SIGHUP};
  struct sigaction before_[std::size(kSignals)] = {};
};

/// To be called in every loop that may last: throws Interrupted with the message of the Interruption that lives, once
/// the program has been asked to end. Who goes on after an InputError must not do so after this one.
void check_interruption();

}  // namespace evbench
