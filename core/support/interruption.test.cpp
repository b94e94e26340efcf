#include "core/support/interruption.hpp"

#include <catch2/catch.hpp>

#include "core/support/error.hpp"

using namespace evbench;

TEST_CASE("A signal that asks to end makes the next check throw, until the interruption is over") {
  {
    const Interruption interruption("a.txt: interrupted");
    CHECK_NOTHROW(check_interruption());
    std::raise(GENERATE(SIGINT, SIGTERM, SIGHUP));
    CHECK(Interruption::is_requested());
    CHECK_THROWS_WITH(check_interruption(), "a.txt: interrupted");
  }
  CHECK_NOTHROW(check_interruption());
}

TEST_CASE("What is thrown then knows the signal, and is told from bad input") {
  const Interruption interruption("a.txt: interrupted");
  std::raise(SIGTERM);
  try {
    check_interruption();
    FAIL("nothing was thrown");
  } catch (const Interrupted& interrupted) {
    CHECK(interrupted.signal() == SIGTERM);
  }
}

TEST_CASE("A signal that was ignored stays so, also afterwards; the others are as before") {
  const auto before = std::signal(SIGHUP, SIG_IGN);
  const auto terminate = std::signal(SIGTERM, SIG_DFL);
  {
    const Interruption interruption("a.txt: interrupted");
    std::raise(SIGHUP);
    CHECK_FALSE(Interruption::is_requested());
  }
  CHECK(std::signal(SIGHUP, before) == SIG_IGN);
  CHECK(std::signal(SIGTERM, terminate) == SIG_DFL);
}

TEST_CASE("The same signal once more would end the program") {
  const Interruption interruption("a.txt: interrupted");
  std::raise(SIGTERM);
  struct sigaction now {};
  ::sigaction(SIGTERM, nullptr, &now);
  CHECK(now.sa_handler == SIG_DFL);
}
