#pragma once

#include <csignal>
#include <string>

#include "core/support/error.hpp"

namespace evbench {

/// The program has been asked to end. Its exit code is 128 + signal, as in a shell: 130 after Ctrl-C.
class Interrupted : public InputError {
 public:
  Interrupted(const std::string& message, int signal) : InputError(message), signal_(signal) {}
  int signal() const { return signal_; }

 private:
  int signal_;
};

/// Handles signals that ask the program to end (SIGINT by Ctrl-C, SIGTERM, SIGHUP) for its lifetime: the next
/// check_interruption() throws, so that unfinished output is removed as after an error. A second signal after half a
/// second or more ends the program at once; earlier ones count as the same, because terminals, shells and `timeout` may
/// each send one. A signal that was ignored before (nohup) stays ignored. Only one object may exist at a time.
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

/// Throws Interrupted with the message of the current Interruption once the program has been asked to end. Call it in
/// every long loop. Code that continues after an InputError must not continue after this one.
void check_interruption();

}  // namespace evbench
