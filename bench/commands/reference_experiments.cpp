#include "bench/commands/reference_experiments.hpp"

#include <fmt/format.h>
#include <sys/wait.h>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>

#include "bench/commands/exit_code.hpp"
#include "core/support/error.hpp"
#include "core/support/interruption.hpp"
#include "eval/json_file.hpp"
#include "eval/record_reader.hpp"

namespace evbench {
namespace fs = std::filesystem;
namespace {

std::vector<std::string> texts(const RecordReader& json, const char* key) {
  std::vector<std::string> texts;
  if (json.at(key).is_null()) return texts;
  if (!json.at(key).is_array()) json.fail(key, "a list of texts");
  for (const Json& item : json.at(key)) {
    if (!item.is_string()) json.fail(key, "a list of texts");
    texts.push_back(item.get<std::string>());
  }
  return texts;
}

}  // namespace

std::vector<ReferenceExperiment> read_reference_experiments(const std::string& path) {
  std::error_code error;
  if (!fs::is_regular_file(path, error)) {
    throw InputError(
        fmt::format("{}: there is no such file here; expected the root of evbench's repository as the "
                    "working folder",
                    path));
  }
  const Json file = read_json_file(path);
  std::vector<ReferenceExperiment> experiments;
  for (const RecordReader& json : RecordReader(file, path).list("experiments")) {
    experiments.push_back({json.text("name"), texts(json, "commands"), texts(json, "needs")});
    if (experiments.back().commands.empty()) json.fail("commands", "at least one command");
  }
  return experiments;
}

int run_reference_experiment(const ReferenceExperiment& experiment, int jobs) {
  for (const std::string& variable : experiment.needs) {
    const char* const value = std::getenv(variable.c_str());  // NOLINT(concurrency-mt-unsafe): one thread
    if (value == nullptr || *value == '\0') {
      throw InputError(fmt::format("the environment variable {} is not set", variable));
    }
  }
  const std::string program = fs::read_symlink("/proc/self/exe").parent_path();  // first in PATH
  const char* const path = std::getenv("PATH");                                  // NOLINT(concurrency-mt-unsafe)
  setenv("PATH", fmt::format("{}:{}", program, path ? path : "").c_str(), 1);    // NOLINT(concurrency-mt-unsafe)
  setenv("EVBENCH_EVENTS", fs::absolute("results/events").c_str(), 0);           // NOLINT(concurrency-mt-unsafe)
  int worst = kExitDone;
  for (std::string command : experiment.commands) {
    if (jobs > 0 && command.starts_with("evbench sweep ")) command += fmt::format(" -j {}", jobs);
    fmt::print("$ {}\n", command);
    std::fflush(stdout);
    const int status = std::system(command.c_str());  // NOLINT: the commands are the repository's own
    const int code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    const std::string message = fmt::format("\"{}\" ended with {}", command, code);
    for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
      if (code == 128 + signal) throw Interrupted(message, signal);
    }
    if (code == kExitNotWritten) throw OutputError(message);
    if (code != kExitDone && code != kExitFailed) throw InputError(message);
    worst = std::max(worst, code);
  }
  return worst;
}

}  // namespace evbench
