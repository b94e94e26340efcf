#pragma once

#include <stdexcept>

namespace evbench {

/// Invalid input: a file, a config, a command line. The message is one sentence that a user can act on: the place (file
/// and line, or place in the JSON), the value found and the one expected. Caught once, in `main`. Numerical failure is
/// not an error but a `Status` in the results.
class InputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Output that can't be written: a full disk, a missing or read-only folder. The program's exit code is a different one
/// (README.md).
class OutputError : public InputError {
 public:
  using InputError::InputError;
};

}  // namespace evbench
