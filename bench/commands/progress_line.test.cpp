#include "bench/commands/progress_line.hpp"

#include <thread>

#include "core/testing/catch2.hpp"
#include "core/testing/data.hpp"

using namespace evbench;
using std::chrono::milliseconds;

namespace {

/// The output of a line on the standard error at this pace, updated now and 50 ms later.
std::string written(const ProgressPace& pace) {
  const testing::TemporaryFolder folder;
  std::fflush(stderr);
  const int kept = ::dup(STDERR_FILENO);
  std::FILE* file = std::fopen(folder.file("err").c_str(), "w");
  REQUIRE(file != nullptr);
  ::dup2(::fileno(file), STDERR_FILENO);
  {
    ProgressLine line("title", pace);
    line.update("one");
    std::this_thread::sleep_for(milliseconds(50));
    line.update("two");
    line.update("three");
  }
  ::dup2(kept, STDERR_FILENO);
  ::close(kept);
  std::fclose(file);
  return testing::read_file(folder.file("err"));
}

}  // namespace

TEST_CASE("A log gets a line every 10 s, from the tenth on, and a terminal one line that is overwritten") {
  const ProgressPace log = progress_pace(false, false, false), terminal = progress_pace(true, false, false);
  CHECK_FALSE(log.rewritten);
  CHECK(log.first == milliseconds(10000));
  CHECK(log.every == milliseconds(10000));
  CHECK(terminal.rewritten);
  CHECK(progress_pace(false, true, false).silent);
  CHECK(progress_pace(true, true, false).silent);
  CHECK_FALSE(progress_pace(true, false, true).rewritten);
}

TEST_CASE("Lines of a log are whole lines, without carriage returns") {
  CHECK(written({false, milliseconds(20), milliseconds(10000), false}) == "title  two\n");
  CHECK(written({false, milliseconds(0), milliseconds(20), false}) == "title  one\ntitle  two\n");
  CHECK(written(progress_pace(false, false, false)).empty());
  CHECK(written({true, milliseconds(0), milliseconds(0), true}).empty());
  CHECK(written({true, milliseconds(0), milliseconds(20), false}).starts_with("\r\033[Ktitle  one\r"));
}
