#include "core/support/interruption.hpp"

#include <sys/wait.h>
#include <unistd.h>

#include "core/support/error.hpp"
#include "core/testing/catch2.hpp"

using namespace evbench;

TEST_CASE("A signal that asks to end makes checks throw while the interruption exists") {
  {
    const Interruption interruption("a.txt: interrupted");
    CHECK_NOTHROW(check_interruption());
    std::raise(GENERATE(SIGINT, SIGTERM, SIGHUP));
    CHECK(Interruption::is_requested());
    CHECK_THROWS_WITH(check_interruption(), "a.txt: interrupted");
  }
  CHECK_NOTHROW(check_interruption());
}

TEST_CASE("The exception knows the signal and is distinct from invalid input") {
  const Interruption interruption("a.txt: interrupted");
  std::raise(SIGTERM);
  try {
    check_interruption();
    FAIL("nothing was thrown");
  } catch (const Interrupted& interrupted) {
    CHECK(interrupted.signal() == SIGTERM);
  }
}

TEST_CASE("An ignored signal stays ignored, and the other handlers are restored afterwards") {
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

TEST_CASE("A signal sent twice at once counts as one signal") {
  const Interruption interruption("a.txt: interrupted");
  std::raise(SIGTERM);
  std::raise(SIGTERM);
  std::raise(SIGINT);
  CHECK_THROWS_WITH(check_interruption(), "a.txt: interrupted");
}

TEST_CASE("A second signal later ends the program", "[slow]") {
  const pid_t child = ::fork();
  REQUIRE(child >= 0);
  if (child == 0) {
    const Interruption interruption("a.txt: interrupted");
    std::raise(SIGTERM);
    ::usleep(700'000);
    std::raise(SIGTERM);
    ::_exit(0);
  }
  int status = 0;
  REQUIRE(::waitpid(child, &status, 0) == child);
  CHECK(WIFSIGNALED(status));
  CHECK(WTERMSIG(status) == SIGTERM);
}
