#include "core/support/trial.hpp"

#include <catch2/catch.hpp>
#include <csignal>

#include "core/support/error.hpp"

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
  CHECK(trial(endless, 1) == "CPU time limit exceeded");
}
