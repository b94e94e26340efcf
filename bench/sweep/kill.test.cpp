#include <fcntl.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <random>

#include "bench/sweep/process_tree.hpp"
#include "bench/testing/sweeps.hpp"
#include "core/support/json.hpp"
#include "core/testing/catch2.hpp"

using namespace evbench;
using namespace evbench::testing;
using Catch::Matchers::ContainsSubstring;

namespace {

/// A sweep of six runs in `folder`, below `out`.
const std::string kKilledSweep = "sweep c.json --vary seed=1..6 --quiet --out ";

/// Starts the program; its process.
pid_t start(const TemporaryFolder& folder, const std::string& out) {
  const pid_t child = ::fork();
  if (child != 0) return child;
  const int null = ::open("/dev/null", O_RDWR);
  for (int stream = 0; stream < 3; ++stream) ::dup2(null, stream);
  if (::chdir(folder.path().c_str()) == 0) {
    ::execl(EVBENCH_PROGRAM, "evbench", "sweep", "c.json", "--vary", "seed=1..6", "--quiet", "--out", out.c_str(),
            nullptr);
  }
  ::_exit(127);
}

int wait_for(pid_t process) {
  int status = 0;
  REQUIRE(::waitpid(process, &status, 0) == process);
  return status;
}

/// How many moments: EVBENCH_KILLS, else 5.
int kills() {
  const char* const variable = std::getenv("EVBENCH_KILLS");  // NOLINT(concurrency-mt-unsafe): no thread sets it
  return variable == nullptr ? 5 : std::atoi(variable);       // NOLINT(cert-err34-c): 0 where it is no number
}

}  // namespace

TEST_CASE("A sweep that is killed at any moment, or whose runs are, has the same bytes once it is repeated",
          "[random]") {
  const TemporaryFolder folder;
  folder.write("c.json", dump_json(tiny_config()));
  REQUIRE(testing::evbench(folder, kKilledSweep + "undisturbed").exit_code == 0);
  const auto expected = results_of(folder.file("undisturbed/tiny"));
  REQUIRE(expected.size() > 60);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> moment(0.05, 0.9);
  int of_sweeps = 0, of_runs = 0, sweeps = 0;
  while (of_sweeps + of_runs < kills()) {
    const std::string out = "killed" + std::to_string(sweeps);
    const pid_t sweep = start(folder, out);
    ::usleep(static_cast<useconds_t>(1e6 * moment(random)));
    const std::vector<pid_t> runs = descendants(sweep);
    if (random() % 2 == 0 && !runs.empty()) {
      of_runs += ::kill(runs[random() % runs.size()], SIGKILL) == 0;
      wait_for(sweep);
    } else {
      ::kill(sweep, SIGKILL);
      of_sweeps += WIFSIGNALED(wait_for(sweep));
    }
    if (random() % 3 != 0) continue;  // the next one goes on here
    // A run that was killed twice is reported as failed: its retry is requested.
    REQUIRE(testing::evbench(folder, kKilledSweep + out + " --retry-failed").exit_code == 0);
    CHECK(difference(expected, results_of(folder.file(out + "/tiny"))) == "");
    ++sweeps;
  }
  REQUIRE(testing::evbench(folder, kKilledSweep + "killed" + std::to_string(sweeps) + " --retry-failed").exit_code ==
          0);
  CHECK(difference(expected, results_of(folder.file("killed" + std::to_string(sweeps) + "/tiny"))) == "");
  CHECK(of_sweeps > 0);
}

TEST_CASE("A complete run is taken once its writer has ended, and no lock stays", "[slow]") {
  const TemporaryFolder folder;
  folder.write("c.json", dump_json(tiny_config()));
  REQUIRE(testing::evbench(folder, kKilledSweep + "out").exit_code == 0);
  const auto expected = results_of(folder.file("out/tiny"));
  const Outcome outcome = testing::shell(
      folder, "lock=$(ls -d out/tiny/*-* | head -1).evbench.lock; flock $lock sleep 1 & sleep 0.2; \"$evbench\" " +
                  kKilledSweep + "out; wait");
  CHECK(outcome.exit_code == 0);
  CHECK(difference(expected, results_of(folder.file("out/tiny"))) == "");
}

TEST_CASE("A sweep on a full disk reports it and loses nothing, and has the same bytes once there is room", "[slow]") {
  const TemporaryFolder folder;
  folder.write("c.json", dump_json(tiny_config()));
  const std::string disk = folder.file("disk");
  std::filesystem::create_directory(disk);
  if (testing::shell(folder, "mount -t tmpfs -o size=64k none disk").exit_code != 0) {
    std::printf("SKIPPED: no tmpfs can be mounted here\n");
    return;
  }
  REQUIRE(testing::evbench(folder, kKilledSweep + "undisturbed").exit_code == 0);
  int full = 0;
  for (int size = 64; full < 20; size += 96) {
    const Outcome outcome = testing::shell(
        folder, "mount -o remount,size=" + std::to_string(size) + "k disk && \"$evbench\" " + kKilledSweep + "disk");
    if (outcome.exit_code == 0) break;
    ++full;
    CHECK(outcome.exit_code == 4);
    CHECK_THAT(outcome.err, ContainsSubstring("No space left on device"));
  }
  const auto made = results_of(disk + "/tiny");
  CHECK(testing::shell(folder, "umount disk").exit_code == 0);
  CHECK(full >= 4);
  CHECK(difference(results_of(folder.file("undisturbed/tiny")), made) == "");
}
