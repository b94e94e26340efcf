#pragma once

#include <optional>
#include <string>

namespace evbench::testing {

/// The path of a file in the folder that an environment variable names (EVBENCH_DATA: real recordings;
/// EVBENCH_PROBLEMS: back-end problems). If the variable is not set: none, and a line that marks the test as skipped.
/// If it is set and the file is missing, the test fails.
std::optional<std::string> data_file(const std::string& name);
std::optional<std::string> problem_file(const std::string& name);

/// A temporary folder that is removed with the object.
class TemporaryFolder {
 public:
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  const std::string& path() const { return path_; }
  std::string file(const std::string& name) const { return path_ + "/" + name; }
  /// Writes a file and returns its path.
  std::string write(const std::string& name, const std::string& content) const;

 private:
  std::string path_;
};

std::string read_file(const std::string& path);

}  // namespace evbench::testing
