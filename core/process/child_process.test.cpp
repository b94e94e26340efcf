#include "core/process/child_process.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <functional>
#include <thread>

#include "core/support/error.hpp"
#include "core/support/interruption.hpp"
#include "core/support/seconds_since.hpp"
#include "core/testing/catch2.hpp"
#include "core/testing/data.hpp"

using namespace evbench;
using Catch::Matchers::ContainsSubstring;

namespace {

std::vector<std::string> shell(const std::string& script) { return {"/bin/sh", "-c", script}; }

/// The error of an exchange with a shell script.
std::string failure(const std::string& script, double timeout = 10.0, const std::string& line = "hello\n") {
  ChildProcess process(shell(script), "");
  try {
    process.exchange(line, timeout, std::size_t{1} << 20);
  } catch (const ProcessError& error) {
    return error.what();
  }
  return "";
}

/// Within two seconds.
bool comes_true(const std::function<bool()>& condition) {
  for (int i = 0; i < 200; ++i) {
    if (condition()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return condition();
}

}  // namespace

TEST_CASE("A child process answers line by line, in its folder") {
  const testing::TemporaryFolder folder;
  ChildProcess process(shell("while read line; do echo \"<$line> in $(pwd -P)\"; done"), folder.path());
  const std::string where = " in " + std::filesystem::canonical(folder.path()).string();
  for (int i = 0; i < 50; ++i) {
    CHECK(process.exchange(std::to_string(i) + "\n", 10.0) == "<" + std::to_string(i) + ">" + where);
  }
  CHECK(process.errors().empty());
}

TEST_CASE("Lines larger than any pipe go both ways while the standard error is flooded", "[slow]") {
  const std::string line = std::string(5'000'000, 'x') + "\n";
  ChildProcess process(shell("yes complaint | head -c 3000000 >&2; read line; echo \"$line\""), "");
  CHECK(process.exchange(line, 60.0) + "\n" == line);
  CHECK_THAT(process.errors().text(""), ContainsSubstring("lines before these)\ncomplaint\n"));
}

TEST_CASE("The end of a child process before its answer is reported with its exit code or signal") {
  CHECK_THAT(failure("exit 3"), ContainsSubstring("ended with exit code 3"));
  CHECK_THAT(failure("read line; exit 0"), ContainsSubstring("ended with exit code 0"));
  CHECK_THAT(failure("kill -SEGV $$"), ContainsSubstring("was ended by signal 11 (Segmentation fault)"));
  CHECK_THAT(failure("sh -c 'kill -ABRT $$'; exit $?"),
             ContainsSubstring("exit code 134") && ContainsSubstring("Aborted"));
  CHECK_THAT(failure("no_such_program_here"), ContainsSubstring("there is no such command"));
  CHECK_THAT(failure("read line; printf 'half an answer'"), ContainsSubstring("ended with exit code 0"));
  // A process that it started keeps its streams open.
  CHECK_THAT(failure("sleep 30 & exit 4"), ContainsSubstring("ended with exit code 4"));
}

TEST_CASE("A child process that closes its streams without ending is an error", "[slow]") {
  CHECK_THAT(failure("exec >&-; sleep 30"), ContainsSubstring("closed its standard output"));
  CHECK_THAT(failure("exec <&-; sleep 30", 10.0, std::string(1'000'000, 'x') + "\n"),
             ContainsSubstring("closed its standard input"));
}

TEST_CASE("A child process that does not answer within the time limit is an error", "[slow]") {
  const auto start = std::chrono::steady_clock::now();
  CHECK_THAT(failure("sleep 30", 0.2), ContainsSubstring("did not answer within 0.2 s"));
  CHECK_THAT(failure("read line; sleep 30", 0.2), ContainsSubstring("did not answer within 0.2 s"));
  // It doesn't even read.
  CHECK_THAT(failure("sleep 30", 0.2, std::string(1'000'000, 'x') + "\n"), ContainsSubstring("did not answer"));
  CHECK(seconds_since(start) < 5.0);
}

TEST_CASE("A child process that writes without end or out of turn is an error") {
  CHECK_THAT(failure("yes | tr -d '\\n'"),
             ContainsSubstring("wrote a line of more than 1048576 bytes, which begins with: yyy"));
  ChildProcess talker(shell("while read line; do echo one; echo two; done"), "");
  CHECK(talker.exchange("a\n", 10.0) == "one");
  std::this_thread::sleep_for(std::chrono::milliseconds(100));
  CHECK_THROWS_WITH(talker.exchange("b\n", 10.0),
                    ContainsSubstring("wrote to its standard output before it was asked: two"));
  CHECK_THAT(failure("echo early; cat", 0.5, std::string(1'000'000, 'x') + "\n"), ContainsSubstring("early"));
}

TEST_CASE("A missing command or folder is reported at the start") {
  CHECK_THROWS_WITH(ChildProcess({"no_such_program_here"}, ""),
                    ContainsSubstring("can't be started: there is no such command"));
  CHECK_THROWS_WITH(ChildProcess({"./none"}, ""), ContainsSubstring("there is no such command"));
  CHECK_THROWS_WITH(ChildProcess({"cat"}, "/no/such/folder"),
                    ContainsSubstring("can't be started in the folder /no/such/folder: No such file"));
  CHECK_THROWS_WITH(ChildProcess({"/"}, ""), ContainsSubstring("can't be started: Permission denied"));
}

TEST_CASE("A program with a relative path is found in the folder of the process") {
  const testing::TemporaryFolder folder;
  const std::string script = folder.write("answer.sh", "#!/bin/sh\nread line; echo \"$1 $line\"\n");
  std::filesystem::permissions(script, std::filesystem::perms::owner_all);
  ChildProcess process({"./answer.sh", "to"}, folder.path());
  CHECK(process.exchange("you\n", 10.0) == "to you");
}

TEST_CASE("All processes that a child started end with it") {
  const testing::TemporaryFolder folder;
  pid_t grandchild = 0;
  {
    ChildProcess process(shell("sleep 100 & echo $! > child; read line; echo ok; wait"), folder.path());
    CHECK(process.exchange("\n", 10.0) == "ok");
    grandchild = std::stoi(testing::read_file(folder.file("child")));
    CHECK(::kill(grandchild, 0) == 0);
  }
  // Another process adopts and reaps it; a zombie has no command line.
  const std::string command_line = "/proc/" + std::to_string(grandchild) + "/cmdline";
  CHECK(comes_true([&] { return !std::filesystem::exists(command_line) || testing::read_file(command_line).empty(); }));
}

TEST_CASE("Children do not inherit one another's pipes, nor files that are open") {
  const testing::TemporaryFolder folder;
  const int open_file = ::open(folder.write("open", "").c_str(), O_RDONLY);  // NOLINT: without O_CLOEXEC
  ChildProcess first(shell("while read line; do echo $line; done; echo end > ended"), folder.path());
  CHECK(first.exchange("a\n", 10.0) == "a");
  ChildProcess second(shell("read line; echo $(ls /proc/$$/fd | wc -l)"), "");
  // 0, 1, 2 and the shell's own descriptors for $(...).
  CHECK(std::stoi(second.exchange("\n", 10.0)) <= 5);
  first.close(5.0);
  CHECK(std::filesystem::exists(folder.file("ended")));
  ::close(open_file);
}

TEST_CASE("A closed child has the grace time to end and is killed afterwards") {
  const testing::TemporaryFolder folder;
  ChildProcess quick(shell("read a; echo 1; cat > /dev/null; sleep 0.1; touch ended"), folder.path());
  CHECK(quick.exchange("\n", 10.0) == "1");
  quick.close(5.0);
  CHECK(std::filesystem::exists(folder.file("ended")));
  ChildProcess slow(shell("read a; echo 1; sleep 100"), "");
  CHECK(slow.exchange("\n", 10.0) == "1");
  const auto start = std::chrono::steady_clock::now();
  slow.close(0.1);
  CHECK(seconds_since(start) < 5.0);
  CHECK_THROWS_AS(slow.exchange("\n", 1.0), ProcessError);
}

TEST_CASE("Waiting for a child ends when the program is asked to end") {
  const auto start = std::chrono::steady_clock::now();
  const Interruption interruption("interrupted");
  ChildProcess process(shell("sleep 100"), "");
  std::jthread signal([] {
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    ::kill(::getpid(), SIGINT);
  });
  CHECK_THROWS_WITH(process.exchange("\n", 60.0), "interrupted");
  CHECK(seconds_since(start) < 5.0);
}

TEST_CASE("Of many lines the last ones are kept, in printable form") {
  LineTail tail;
  CHECK(tail.empty());
  CHECK(tail.text("  ").empty());
  for (int i = 0; i < 30; ++i) tail.add("line " + std::to_string(i) + "\n");
  tail.add("the last\x1b[1m ");
  tail.add("one");
  CHECK_THAT(tail.text("  "),
             ContainsSubstring("  (11 lines before these)\n  line 11\n") && ContainsSubstring("  the last?[1m one"));
  tail.add(std::string(10'000'000, 'x') + "\n");
  const std::string text = tail.text("");
  CHECK(text.size() < LineTail::kLines * (LineTail::kLength + 10));
  CHECK(text.ends_with("xxx..."));
  CHECK(printable("h\xc3\xa4lt", 2) == "h...");
  CHECK(printable("h\xc3\xa4lt", 3) == "h\xc3\xa4...");
}
