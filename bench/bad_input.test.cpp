#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <filesystem>
#include <iostream>

#include "bench/commands/exit_code.hpp"
#include "bench/testing/program.hpp"
#include "core/support/json.hpp"
#include "core/testing/catch2.hpp"

using namespace evbench;
using namespace evbench::testing;
using Catch::Matchers::ContainsSubstring;

// Passes each kind of bad input once to the program: exit code 2, a message with the place on stderr, and no file left
// under a final name. The readers' own tests cover the kinds in detail.

namespace {

void check_refused(const TemporaryFolder& folder, const std::string& arguments, const std::string& message,
                   int exit_code = kExitBadInput) {
  const Outcome outcome = testing::evbench(folder, arguments);
  INFO(arguments << "\n" << outcome.err);
  CHECK(outcome.exit_code == exit_code);
  CHECK_THAT(outcome.err, Catch::Matchers::StartsWith("evbench " + arguments.substr(0, arguments.find(' ')) + ": ") &&
                              ContainsSubstring(message));
  CHECK(std::ranges::count(outcome.err, '\n') == 1);
  CHECK(outcome.out.empty());
}

/// Writes a recording with one file replaced.
void check_file_refused(const std::string& name, const std::string& content, const std::string& message) {
  const TemporaryFolder folder;
  write_recording(folder);
  folder.write(name, content);
  check_refused(folder, "run recording.json", message);
  CHECK(names_in(folder.file("results/recording")).empty());
}

}  // namespace

TEST_CASE("A file that is missing ends the program with its name", "[slow]") {
  const TemporaryFolder folder;
  write_recording(folder);
  check_refused(folder, "run nowhere.json", "nowhere.json: no such file");
  check_refused(folder, "run recording.json --set frontend.tracks=no.txt", folder.file("no.txt") + ": no such file");
  check_refused(folder, "run recording.json --set source.folder=no", folder.file("no/calib.txt") + ": no such file");
  check_refused(folder, "run recording.json --set source.ground_truth=no.txt", "no.txt: no such file");
  check_refused(folder, "run recording.json --set 'source.folder=${EVBENCH_NOT_SET}/x'", "EVBENCH_NOT_SET is not set");
  check_refused(folder, "eval groundtruth.txt no.txt", "no.txt: no such file");
  check_refused(folder, "solve no.txt", "no.txt: no such file");
  CHECK(names_in(folder.file("results/recording")).empty());
}

TEST_CASE("A file that is empty, truncated or damaged ends the program with the file and the line", "[slow]") {
  check_file_refused("tracks.txt", "", "tracks.txt: holds no observation");
  check_file_refused("groundtruth.txt", "# t x y z\n", "groundtruth.txt: holds no pose");
  check_file_refused("calib.txt", "", "calib.txt: is empty");
  check_file_refused("recording.json", "", "recording.json: is not JSON");
  check_file_refused("recording.json", "{\"name\": \"x\"", "recording.json: is not JSON");
  check_file_refused("tracks.txt", "1 0.1 5 5\n1 0.2 5\n", "tracks.txt:2: has 3 columns; expected 4");
  check_file_refused("groundtruth.txt", "0 0 0 0 0 0 0 1\n1 0 0 0 0\n", "groundtruth.txt:2: has 5 columns; expected 8");
  check_file_refused("calib.txt", "200 200 120\n", "calib.txt:1: has 3 columns; expected 9");
}

TEST_CASE("A gzip file that ends too early is reported as truncated", "[slow]") {
  const TemporaryFolder folder;
  write_recording(folder);
  const std::string text = read_file(folder.file("tracks.txt"));
  gzFile file = gzopen(folder.file("tracks.txt.gz").c_str(), "wb");
  REQUIRE(gzwrite(file, text.data(), static_cast<unsigned>(text.size())) > 0);
  gzclose(file);
  CHECK(testing::evbench(folder, "run recording.json --quiet --set frontend.tracks=tracks.txt.gz").exit_code == 3);
  const std::string bytes = read_file(folder.file("tracks.txt.gz"));
  folder.write("tracks.txt.gz", bytes.substr(0, bytes.size() / 2));
  check_refused(folder, "run recording.json --set frontend.tracks=tracks.txt.gz", "truncated");
}

TEST_CASE("Numbers that are not finite end the program with the line", "[slow]") {
  check_file_refused("tracks.txt", "1 0.1 nan 5\n", "tracks.txt:1: x is \"nan\"");
  check_file_refused("tracks.txt", "1 0.1 5 5\n1 inf 5 5\n", "tracks.txt:2: the time is \"inf\"");
  check_file_refused("groundtruth.txt", "0 0 nan 0 0 0 0 1\n", "groundtruth.txt:1");
  check_file_refused("calib.txt", "200 inf 120 90 0 0 0 0 0\n", "calib.txt:1");
}

TEST_CASE("Ground truth whose stamps are unsorted ends the program with the line", "[slow]") {
  check_file_refused("groundtruth.txt", "1 0 0 0 0 0 0 1\n0.5 0 0 0 0 0 0 1\n", "groundtruth.txt:2: time 0.5");
}

TEST_CASE("Tracks that are unsorted, repeated, of one observation or outside the image are used, and the log says so") {
  const TemporaryFolder folder;
  write_recording(folder);
  folder.write("tracks.txt",
               read_file(folder.file("tracks.txt")) + "3 0.001 5 5\n3 0.001 6 6\n77 0.5 9 9\n4 0.7 -3 9\n5 44 9 9\n");
  const Outcome outcome = testing::shell(folder, "\"$evbench\" run recording.json --quiet; cat results/*/*/log.txt");
  CHECK(outcome.err.empty());
  CHECK_THAT(outcome.out, ContainsSubstring("out of order") && ContainsSubstring("track and time of another") &&
                              ContainsSubstring("single observation") && ContainsSubstring("outside the image") &&
                              ContainsSubstring("1 observations outside 0 to 1 s (left out)"));
}

TEST_CASE("Observations that all lie outside the ground truth's time are an error", "[slow]") {
  check_file_refused("tracks.txt", "1 50 5 5\n1 51 5 5\n", "tracks.txt: no observation is left between 0 and 1 s");
  const TemporaryFolder folder;
  write_recording(folder);
  check_refused(folder, "run recording.json --set source.time_range=[5,6]",
                "recording.json: source.time_range: 5 to 6 s does not meet the ground truth");
  check_refused(folder, "run recording.json --set source.time_range=[1,0]", "expected rising numbers");
  folder.write("late.txt", "50 0 0 0 0 0 0 1\n51 1 0 0 0 0 0 1\n52 2 0 0 0 0 0 1\n");
  check_refused(folder, "eval groundtruth.txt late.txt --json scores.json", "late.txt");
  CHECK_FALSE(std::filesystem::exists(folder.file("scores.json")));
}

TEST_CASE("An unknown key or plugin and a value out of range end the program with the place and the nearest name",
          "[slow]") {
  const TemporaryFolder folder;
  folder.write("c.json", dump_json(short_config()));
  check_refused(folder, "run c.json --set backend.batch_duratoin=1",
                "c.json: backend: unknown key \"batch_duratoin\"; did you mean \"batch_duration\"?");
  check_refused(folder, "run c.json --set backend.type=gp_mop", "did you mean \"gp_map\"?");
  check_refused(folder, "run c.json --set source.duration=0", "c.json: source.duration: 0 is out of range");
  check_refused(folder, "run c.json --set source.duration=long", "expected number, found \"long\"");
  check_refused(folder, "run c.json --set source.tracks.lifetime=[2,1]", "c.json: source.tracks.lifetime: expected");
  check_refused(folder, "run c.json --set source.camera.coefficients=[1]", "c.json: source.camera.coefficients: has 1");
  CHECK(names_in(folder.path()) == std::set<std::string>{"c.json"});
}

TEST_CASE("A front-end that does not suit the source is an error with its place") {
  const TemporaryFolder folder;
  write_recording(folder);
  check_refused(folder, "run recording.json --set 'frontend={\"type\": \"oracle\"}'",
                "recording.json: frontend: oracle needs a source");
}

TEST_CASE("A folder for results that can't be made ends the program before any work", "[slow]") {
  const TemporaryFolder folder;
  folder.write("c.json", dump_json(short_config()));
  folder.write("file", "");
  check_refused(folder, "run c.json --out file", "file/short: can't be made: Not a directory", kExitNotWritten);
  check_refused(folder, "run c.json --out /dev/full", "/dev/full/short: can't be made", kExitNotWritten);
}

TEST_CASE("A full disk is an error wherever the program writes", "[slow]") {
  const TemporaryFolder folder;
  write_recording(folder);
  check_refused(folder, "eval groundtruth.txt groundtruth.txt --json /dev/full",
                "/dev/full: can't be written: No space", kExitNotWritten);
  for (const char* command : {"list", "describe config", "--help", "eval groundtruth.txt groundtruth.txt"}) {
    INFO(command);
    const Outcome outcome = testing::evbench(folder, std::string(command) + " > /dev/full");
    CHECK(outcome.exit_code == kExitNotWritten);
    CHECK_THAT(outcome.err, ContainsSubstring("standard output"));
  }
}

TEST_CASE("A file that can't be written whole leaves the old one unchanged", "[slow]") {
  const TemporaryFolder folder;
  write_recording(folder);
  folder.write("scores.json", "before");
  // A limit on the size of files has the same effect as a full disk.
  const Outcome outcome = testing::shell(
      folder,
      "trap '' XFSZ; ulimit -f 1; \"$evbench\" eval groundtruth.txt groundtruth.txt --json scores.json --force");
  CHECK(outcome.exit_code == kExitNotWritten);
  CHECK_THAT(outcome.err, ContainsSubstring("scores.json: can't be written") && !ContainsSubstring(".part"));
  CHECK(read_file(folder.file("scores.json")) == "before");
  CHECK(names_in(folder.path()).size() == 5);
  CHECK_THAT(testing::evbench(folder, "eval groundtruth.txt groundtruth.txt --json no/x.json").err,
             ContainsSubstring("no/x.json: can't be written: No such file") && !ContainsSubstring(".part"));
}

TEST_CASE("A run that can't be written whole leaves the old run unchanged", "[slow]") {
  const TemporaryFolder folder;
  folder.write("c.json", dump_json(short_config()));
  REQUIRE(testing::evbench(folder, "run c.json --quiet").exit_code == 0);
  const std::string before = testing::shell(folder, "cd results/short && sha256sum */*").out;
  const Outcome outcome = testing::shell(
      folder, "trap '' XFSZ; ulimit -f 8; \"$evbench\" run c.json --force; code=$?; ulimit -f unlimited; exit $code");
  CHECK(outcome.exit_code == kExitNotWritten);
  CHECK_THAT(outcome.err, ContainsSubstring("can't be written: File too large") && !ContainsSubstring(".part"));
  CHECK(testing::shell(folder, "cd results/short && sha256sum */*").out == before);
  CHECK(runs_of(folder.file("results/short")).size() == 1);
}

TEST_CASE("A run on a full disk leaves no files", "[slow]") {
  const TemporaryFolder folder;
  folder.write("c.json", dump_json(short_config()));
  std::filesystem::create_directory(folder.file("small"));
  const std::string unshare = ::geteuid() == 0 ? "unshare -m" : "unshare -rm";
  const std::string mount = unshare + " sh -c 'mount -t tmpfs -o size=32k tmpfs small";
  if (testing::shell(folder, mount + "'").exit_code != 0) {
    std::cout << "SKIPPED: needs the right to mount a small file system\n";
    SUCCEED("skipped");
    return;
  }
  const Outcome outcome = testing::shell(
      folder, mount + " && \"$evbench\" run c.json --out small; code=$?; find small -type f; exit $code'");
  CHECK(outcome.exit_code == kExitNotWritten);
  CHECK_THAT(outcome.err, ContainsSubstring("can't be written: No space left on device"));
  CHECK(outcome.out.empty());
}
