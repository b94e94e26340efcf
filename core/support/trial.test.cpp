#include "core/support/trial.hpp"

#include <unistd.h>

#include <catch2/catch.hpp>
#include <csignal>

#include "core/support/error.hpp"
#include "core/support/interruption.hpp"

using namespace evbench;

TEST_CASE("A trial says what kills its copy of the process") {
  CHECK(trial([] { ::raise(SIGSEGV); }, 10) == "Segmentation fault");
  CHECK(trial([] { ::raise(SIGABRT); }, 10) == "Aborted");
}

TEST_CASE("A trial of work that returns or throws says nothing, and changes nothing here") {
  int value = 1;
  CHECK(trial([&] { value = 2; }, 10).empty());
  CHECK(value == 1);
  CHECK(trial([] { throw InputError("broken"); }, 10).empty());
}

TEST_CASE("A trial ends work that does not end") {
  const auto endless = [] {
    for (volatile bool go = true; go;) {
    }
  };
  // The time by the clock is over first where the processor has much else to do.
  CHECK_THAT(trial(endless, 1), Catch::Equals("CPU time limit exceeded") || Catch::Equals("Time limit exceeded"));
  CHECK(trial([] { ::raise(SIGALRM); }, 10) == "Time limit exceeded");
}

TEST_CASE("A trial ends when the program is asked to end") {
  const Interruption interruption("interrupted");
  const auto interrupt_and_wait = [] {
    ::kill(::getppid(), SIGTERM);
    while (true) ::pause();
  };
  CHECK_THROWS_WITH(trial(interrupt_and_wait, 1), "interrupted");
}
