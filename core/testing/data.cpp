#include "core/testing/data.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <sstream>

#include "core/testing/catch2.hpp"

namespace evbench::testing {
namespace {

std::optional<std::string> file_below(const char* variable, const std::string& name) {
  const char* const folder = std::getenv(variable);
  if (folder == nullptr || *folder == '\0') {
    std::cout << "SKIPPED: needs " << name << " in the folder that " << variable << " names\n";
    SUCCEED("skipped");
    return std::nullopt;
  }
  const std::string path = std::string(folder) + "/" + name;
  INFO(path);
  REQUIRE(std::filesystem::exists(path));
  return path;
}

}  // namespace

std::optional<std::string> data_file(const std::string& name) { return file_below("EVBENCH_DATA", name); }
std::optional<std::string> problem_file(const std::string& name) { return file_below("EVBENCH_PROBLEMS", name); }

TemporaryFolder::TemporaryFolder() {
  std::string pattern = (std::filesystem::temp_directory_path() / "evbench-test-XXXXXX").string();
  REQUIRE(::mkdtemp(pattern.data()) != nullptr);
  path_ = pattern;
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

std::string TemporaryFolder::write(const std::string& name, const std::string& content) const {
  std::ofstream(file(name), std::ios::binary) << content;
  return file(name);
}

std::string read_file(const std::string& path) {
  std::ostringstream content;
  content << std::ifstream(path, std::ios::binary).rdbuf();
  return content.str();
}

}  // namespace evbench::testing
