#include "core/datasets/catalogue.hpp"

#include <cstdlib>
#include <filesystem>

#include "core/support/error.hpp"
#include "core/testing/catch2.hpp"
#include "core/testing/data.hpp"

using namespace evbench;
using Catch::Matchers::ContainsSubstring;

namespace {

/// Sets an environment variable for its lifetime.
class Variable {
 public:
  Variable(const char* name, const std::string& value) : name_(name) { ::setenv(name, value.c_str(), 1); }
  ~Variable() { ::unsetenv(name_); }
  Variable(const Variable&) = delete;
  Variable& operator=(const Variable&) = delete;

 private:
  const char* name_;
};

std::string collection(const std::string& file, const std::string& sequences) {
  return R"({"collections": [{"name": "c", "title": "t", "homepage": "h", "licence": "l", "verified": "v",
    "limit_gib": 1, "files": [)" +
         file + R"(], "sequences": [)" + sequences + "]}]}";
}

const char* const kSequence = R"({"name": "a", "description": "d"})";

}  // namespace

TEST_CASE("The catalogue of the program has the Event-Camera Dataset with addresses and licence") {
  const auto catalogue = read_catalogue(catalogue_path());
  const Dataset dataset = find_dataset(catalogue, "ecd/dynamic_6dof");
  REQUIRE(dataset.files.size() == 1);
  CHECK(dataset.files[0].url == "https://rpg.ifi.uzh.ch/datasets/davis/dynamic_6dof.zip");
  CHECK(dataset.files[0].unpack);
  CHECK(dataset.licence == "CC BY-NC-SA 3.0");
  CHECK_THROWS_WITH(find_dataset(catalogue, "ecd/dynamic_6d0f"),
                    ContainsSubstring("did you mean \"ecd/dynamic_6dof\"?"));
}

TEST_CASE("A downloaded dataset is found by its name, and the error for a missing one names the command to fetch it") {
  const testing::TemporaryFolder folder;
  const Variable variable("EVBENCH_DATASETS", folder.path());
  CHECK_THROWS_WITH(existing_dataset_folder("ecd/dynamic_6dof", "here"),
                    ContainsSubstring("here: ") && ContainsSubstring("evbench dataset get ecd/dynamic_6dof"));
  CHECK_THROWS_WITH(existing_dataset_folder("ecd/dynamic_6d0f", "here"), ContainsSubstring("did you mean"));
  std::filesystem::create_directories(folder.file("ecd/dynamic_6dof"));
  CHECK(existing_dataset_folder("ecd/dynamic_6dof", "here") == folder.file("ecd/dynamic_6dof"));
  for (const char* name : {"../x", "/etc", "ecd//x", "", "ecd/"}) {
    CHECK_THROWS_WITH(existing_dataset_folder(name, "here"), ContainsSubstring("is no name of a dataset"));
  }
}

TEST_CASE("A damaged catalogue is refused with its place") {
  const testing::TemporaryFolder folder;
  const auto refused = [&](const std::string& text, const std::string& message) {
    CHECK_THROWS_WITH(read_catalogue(folder.write("c.json", text)),
                      ContainsSubstring("c.json") && ContainsSubstring(message));
  };
  refused("{", "parse error");
  refused("{}", "collections");
  refused(collection(R"({"url": "ftp://x/{name}"})", kSequence), "c/a: url: is \"ftp://x/a\"");
  for (const char* url : {"http://x", "http://x/", "http://x/f/?a=b.zip", "http://x/..", "http://x/.f"}) {
    refused(collection(std::string(R"({"url": ")") + url + "\"}", kSequence),
            "expected one that ends in a file's name");
  }
  refused(collection(R"({"url": "http://x/f"}, {"url": "http://y/f?a=b"})", kSequence),
          "two of the files are called \"f\"");
  refused(collection(R"({"url": "http://x/f", "sha256": "12"})", kSequence), "sha256");
  refused(collection(R"({"url": "http://x/f"})", R"({"name": "../a", "description": "d"})"), "expected words");
  refused(collection(R"({"url": "http://x/f"})", std::string(kSequence) + ", " + kSequence), "is there twice");
  CHECK_THROWS_AS(read_catalogue(folder.file("no.json")), InputError);
}
