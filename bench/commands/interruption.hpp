#pragma once

#include <csignal>
#include <string>

#include "core/support/error.hpp"

namespace evbench {

/// For commands that write a big file: Ctrl-C ends them as an error does, so that what they began is removed.
class Interruption {
 public:
  Interruption() {
    for (const int signal : {SIGINT, SIGTERM, SIGHUP}) std::signal(signal, [](int) { requested_ = 1; });
  }
  ~Interruption() {
    for (const int signal : {SIGINT, SIGTERM, SIGHUP}) std::signal(signal, SIG_DFL);
  }
  Interruption(const Interruption&) = delete;
  Interruption& operator=(const Interruption&) = delete;

  /// To be called now and then. Throws InputError when the program has been asked to end.
  void check(const std::string& out) const {
    if (requested_ != 0) throw InputError(out + ": interrupted; nothing was written");
  }

 private:
  static inline volatile std::sig_atomic_t requested_ = 0;
};

}  // namespace evbench
