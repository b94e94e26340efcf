#include "bench/job.hpp"

#include <filesystem>
#include <set>

#include "bench/testing/keys.hpp"
#include "bench/testing/program.hpp"
#include "core/io/sha256.hpp"
#include "core/support/error.hpp"
#include "core/support/json.hpp"
#include "core/testing/catch2.hpp"

using namespace evbench;
using namespace evbench::testing;
using Catch::Matchers::ContainsSubstring;

namespace {

RunConfig read_first(const std::string& path, const std::vector<std::string>& overrides = {}) {
  return read_experiment(path, overrides, known_plugins()).runs.at(0);
}

}  // namespace

TEST_CASE("A job's key is the beginning of the digest of its identity, which has neither names nor paths") {
  const TemporaryFolder folder;
  write_recording(folder);
  const JobIdentity identity = identity_of(read_first(folder.file("recording.json")));
  CHECK(identity.key == "bundle_adjustment-" + sha256(identity.text).substr(0, 10));
  const Json json = parse_json(identity.text);
  for (const char* key : {"pipeline_version", "seed", "trajectory_rate", "pipeline", "source", "frontend", "backend"}) {
    CHECK(json.contains(key));
  }
  CHECK(json["frontend"]["files"] == Json{sha256_file(folder.file("tracks.txt"))});
  CHECK(json["source"]["files"].size() == 2);
  CHECK(json["backend"]["version"].is_number_integer());
  CHECK_FALSE(json["backend"].contains("library"));
  CHECK_THAT(identity.text,
             !ContainsSubstring(folder.path()) && !ContainsSubstring("tracks.txt") && !ContainsSubstring("label"));
}

TEST_CASE("Moved data keep their job's key, and changed data at the same path do not") {
  const TemporaryFolder here, there;
  for (const TemporaryFolder* folder : {&here, &there}) write_recording(*folder);
  const auto key = [](const TemporaryFolder& folder) { return key_of(read_first(folder.file("recording.json"))); };
  const std::string before = key(here);
  CHECK(key(there) == before);
  std::filesystem::rename(there.file("tracks.txt"), there.file("renamed.txt"));
  CHECK(key_of(read_first(there.file("recording.json"), {"frontend.tracks=renamed.txt"})) == before);
  for (const char* name : {"tracks.txt", "groundtruth.txt", "calib.txt"}) {
    INFO(name);
    const std::string content = read_file(here.file(name));
    here.write(name, content + "# one more line\n");
    CHECK(key(here) != before);
    here.write(name, content);
    CHECK(key(here) == before);
  }
}

TEST_CASE("A missing file of a plugin is an error with its name before anything is run") {
  const TemporaryFolder folder;
  write_recording(folder);
  const RunConfig run = read_first(folder.file("recording.json"), {"frontend.tracks=no.txt"});
  CHECK_THROWS_WITH(identity_of(run), folder.file("no.txt") + ": no such file");
}

TEST_CASE("Digests are of a file's bytes, and of a folder's files with their names") {
  const TemporaryFolder folder;
  folder.write("a.txt", "abc");
  Digests digests;
  CHECK(digests.of(folder.file("a.txt")) == sha256("abc"));
  folder.write("a.txt", "changed");
  CHECK(digests.of(folder.file("a.txt")) == sha256("abc"));  // read once
  std::filesystem::create_directories(folder.file("x/deep"));
  const auto digest = [&] { return Digests().of(folder.file("x")); };
  std::set<std::string> seen = {digest()};
  folder.write("x/one", "1");
  CHECK(seen.insert(digest()).second);
  folder.write("x/deep/two", "2");
  CHECK(seen.insert(digest()).second);
  folder.write("x/deep/two", "3");
  CHECK(seen.insert(digest()).second);
  std::filesystem::rename(folder.file("x/one"), folder.file("x/other"));
  CHECK(seen.insert(digest()).second);
}
