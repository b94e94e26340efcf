#pragma once

#include <cstdio>
#include <memory>

namespace evbench {

struct CloseFile {
  void operator()(std::FILE* file) const { std::fclose(file); }
};

/// A file that is closed with the handle; what could not be written is then not said: std::fflush() it before.
using FileHandle = std::unique_ptr<std::FILE, CloseFile>;

}  // namespace evbench
