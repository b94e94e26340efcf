#include "bench/sweep/process_pool.hpp"

#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <cstring>
#include <stdexcept>

#include "bench/sweep/process_tree.hpp"
#include "core/support/error.hpp"
#include "core/testing/catch2.hpp"

using namespace evbench;
using Catch::Matchers::ContainsSubstring;

namespace {

Ending run(ProcessPool& pool, const std::function<std::string()>& work, const RunLimits& limits = {}) {
  pool.start(7, work, limits);
  std::vector<Ending> endings;
  while (endings.empty()) endings = pool.wait(std::chrono::milliseconds(50));
  REQUIRE(endings.size() == 1);
  CHECK(endings[0].id == 7);
  return endings[0];
}

Ending run(const std::function<std::string()>& work, const RunLimits& limits = {}) {
  ProcessPool pool;
  return run(pool, work, limits);
}

bool is_alive(pid_t process) { return ::kill(process, 0) == 0; }

/// A process in a session of its own that sleeps; its number.
pid_t leave_sleeper() {
  const pid_t child = ::fork();
  if (child == 0) {
    ::setsid();
    ::sleep(100);
    ::_exit(0);
  }
  return child;
}

}  // namespace

TEST_CASE("A pool's process reports the result of its work, of any length, and its output") {
  const std::string report(200'000, 'x');
  const Ending ending = run([&] {
    std::puts("a line");
    return report;
  });
  CHECK(ending.report == report);
  CHECK(ending.reason.empty());
  CHECK(ending.log == std::vector<std::string>{"a line"});
  CHECK(ending.seconds > 0.0);
}

TEST_CASE("A pool's process that crashes, exits or throws is reported with how it ended and its output") {
  ProcessPool pool;
  const auto raise = [](int signal) {
    return [signal]() -> std::string {
      ::signal(signal, SIG_DFL);  // of a sanitizer
      ::raise(signal);
      return "never";
    };
  };
  const Ending crash = run(pool, raise(SIGSEGV));
  CHECK(crash.reason == "killed by SIGSEGV");
  CHECK(crash.report.empty());
  CHECK_FALSE(crash.from_outside);
  CHECK(run(pool, raise(SIGABRT)).reason == "killed by SIGABRT");
  const Ending killed = run(pool, raise(SIGKILL));
  CHECK(killed.reason == "killed by SIGKILL");
  CHECK(killed.from_outside);
  CHECK(run(pool, []() -> std::string { ::_exit(0); }).reason == "ended with exit code 0 before it was done");
  CHECK(run(pool, []() -> std::string { std::exit(3); }).reason == "ended with exit code 3 before it was done");
  const Ending thrown = run(pool, []() -> std::string { throw std::runtime_error("what is wrong"); });
  CHECK(thrown.reason == "ended with exit code 1 before it was done");
  CHECK(thrown.log == std::vector<std::string>{"what is wrong"});
}

TEST_CASE("Limits of time and memory of a pool's process are enforced, including its children's", "[slow]") {
  ProcessPool pool;
  const Ending slow = run(pool,
                          []() -> std::string {
                            ::sleep(100);
                            return "never";
                          },
                          {0.2, 0.0});
  CHECK(slow.reason == "timeout after 0.2 s");
  CHECK_FALSE(slow.from_outside);
  CHECK(slow.seconds < 50.0);
  const auto eat = [] {
    std::vector<char> memory(std::size_t{1000} << 20U);
    for (std::size_t i = 0; i < memory.size(); i += 4096) memory[i] = 1;
    ::sleep(100);
    return std::string("never");
  };
  const double limit = resident_mib(::getpid()) + 300.0;
  CHECK_THAT(run(pool, eat, {0.0, limit}).reason, ContainsSubstring("killed: ") && ContainsSubstring(", limit "));
  const auto let_eat = [&] {
    if (::fork() == 0) eat();
    ::sleep(100);
    return std::string("never");
  };
  CHECK_THAT(run(pool, let_eat, {0.0, 2.0 * limit}).reason, ContainsSubstring("killed: "));
}

TEST_CASE("Descendants of a pool's process end with it, in any session, and however the process ended") {
  ProcessPool pool;
  const Ending done = run(pool, [] { return std::to_string(leave_sleeper()); });
  CHECK_FALSE(is_alive(std::stoi(done.report)));
  const auto of_log = [](const Ending& ending) { return std::stoi(ending.log.at(0)); };
  const auto leave = [] {
    std::printf("%d\n", leave_sleeper());
    std::fflush(stdout);
  };
  const Ending crashed = run(pool, [&]() -> std::string {
    leave();
    ::signal(SIGABRT, SIG_DFL);  // not the test program's, which prints much
    ::abort();
  });
  CHECK_FALSE(is_alive(of_log(crashed)));
  const Ending slow = run(pool,
                          [&]() -> std::string {
                            leave();
                            ::sleep(100);
                            return "";
                          },
                          {0.3, 0.0});
  CHECK_FALSE(is_alive(of_log(slow)));
}

TEST_CASE("A pool's processes end with the program, also when it is killed", "[slow]") {
  int pipe[2];
  REQUIRE(::pipe(pipe) == 0);
  const pid_t program = ::fork();
  if (program == 0) {
    ProcessPool pool;
    const auto tell_and_sleep = [&]() -> std::string {
      const pid_t own = ::getpid();
      if (::write(pipe[1], &own, sizeof own) == sizeof own) ::sleep(100);
      return "";
    };
    pool.start(0, tell_and_sleep, {});
    while (true) pool.wait(std::chrono::milliseconds(50));
  }
  pid_t process = 0;
  REQUIRE(::read(pipe[0], &process, sizeof process) == sizeof process);
  CHECK(is_alive(process));
  ::kill(program, SIGKILL);
  REQUIRE(::waitpid(program, nullptr, 0) == program);
  for (int i = 0; i < 500 && is_alive(process); ++i) ::usleep(10'000);
  CHECK_FALSE(is_alive(process));
}
