#pragma once

#include <cstdio>
#include <memory>

namespace evbench {

struct CloseFile {
  void operator()(std::FILE* file) const { std::fclose(file); }
};

/// A file that is closed with the handle. Closing does not report write errors: call std::fflush() before.
using FileHandle = std::unique_ptr<std::FILE, CloseFile>;

}  // namespace evbench
